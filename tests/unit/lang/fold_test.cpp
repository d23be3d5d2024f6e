#include "core/lang/fold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace aerosol::lang {
namespace {

std::optional<Constant> fold(Op op, const Type& type, std::vector<Constant> values,
                             const Constant* previous = nullptr) {
  std::vector<const Constant*> pointers;
  for (const Constant& value : values) pointers.push_back(&value);
  return foldOperation(op, type, pointers, previous);
}

std::int32_t ints(Op op, std::int32_t a, std::int32_t b) {
  return fold(op, types::integer, {Constant::ofInt(a), Constant::ofInt(b)})->asInt();
}
float floats(Op op, float a, float b) {
  return fold(op, types::floating, {Constant::ofFloat(a), Constant::ofFloat(b)})->asFloat();
}

constexpr std::int32_t least = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();

TEST(Fold, IntsWrapAndNeverTrap) {
  EXPECT_EQ(ints(Op::add, most, 1), least);
  EXPECT_EQ(ints(Op::multiply, most, most), 1);
  EXPECT_EQ(ints(Op::divide, least, -1), least);
  EXPECT_EQ(ints(Op::modulo, least, -1), 0);
  EXPECT_EQ(ints(Op::divide, 5, 0), 0);
  EXPECT_EQ(ints(Op::modulo, 5, 0), 0);
  EXPECT_EQ(ints(Op::divide, -7, 2), -3);
  EXPECT_EQ(ints(Op::modulo, -7, 2), -1);
  EXPECT_EQ(ints(Op::shiftLeft, 1, 33), 2);
  EXPECT_EQ(ints(Op::shiftRight, -8, 1), -4);
  EXPECT_EQ(fold(Op::negate, types::integer, {Constant::ofInt(least)})->asInt(), least);
}

TEST(Fold, FloatsDivideByZeroToZero) {
  EXPECT_EQ(floats(Op::divide, 1, 0), 0.0f);
  EXPECT_FALSE(std::signbit(floats(Op::divide, -1, 0)));
  EXPECT_EQ(floats(Op::divide, 1, 3), 1.0f / 3.0f);
}

TEST(Fold, FloatToIntSaturates) {
  const auto toInt = [](float f) { return fold(Op::toInt, types::integer, {Constant::ofFloat(f)})->asInt(); };
  EXPECT_EQ(toInt(1e20f), most);
  EXPECT_EQ(toInt(-1e20f), least);
  EXPECT_EQ(toInt(-2147483648.0f), least);
  EXPECT_EQ(toInt(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(toInt(-2.9f), -2);
}

TEST(Fold, FloatsServeAllComponents) {
  const Constant color{types::color, std::vector<float>{1, 2, 4}};
  const auto half = fold(Op::divide, types::color, {Constant::ofFloat(2), color});
  EXPECT_EQ(half->value, ConstantValue(std::vector<float>{2, 1, 0.5f}));
  EXPECT_EQ(fold(Op::equal, types::integer, {Constant{types::color, std::vector<float>{3, 3, 3}}, Constant::ofFloat(3)})
                ->asInt(),
            1);
}

TEST(Fold, NaNEqualsNothing) {
  const Constant nan = Constant::ofFloat(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(fold(Op::equal, types::integer, {nan, nan})->asInt(), 0);
  EXPECT_EQ(fold(Op::notEqual, types::integer, {nan, nan})->asInt(), 1);
  EXPECT_EQ(fold(Op::less, types::integer, {nan, nan})->asInt(), 0);
  EXPECT_EQ(fold(Op::toBool, types::integer, {nan})->asInt(), 1);
  EXPECT_TRUE(sameBits(nan, nan));
  EXPECT_FALSE(sameBits(Constant::ofFloat(0.0f), Constant::ofFloat(-0.0f)));
}

TEST(Fold, LeavesWhatTheRunTimeDecides) {
  const Constant identity = *convertConstant(Constant::ofFloat(1), types::matrix);
  EXPECT_FALSE(fold(Op::multiply, types::matrix, {identity, identity}));
  const Constant array{types::floating.arrayOf(2), std::vector<float>{1, 2}};
  EXPECT_FALSE(fold(Op::element, types::floating, {array, Constant::ofInt(2)}));
  EXPECT_FALSE(
      fold(Op::component, types::floating, {Constant{types::color, std::vector<float>{1, 2, 3}}, Constant::ofInt(-1)}));
  EXPECT_FALSE(fold(Op::call, types::floating, {Constant::ofFloat(1)}));
}

TEST(Fold, SetsPartsOfWhatWasThere) {
  const Constant array{types::color.arrayOf(2), std::vector<float>{1, 2, 3, 4, 5, 6}};
  const Constant color{types::color, std::vector<float>{7, 8, 9}};
  const auto changed = fold(Op::setElement, array.type, {Constant::ofInt(1), color}, &array);
  EXPECT_EQ(changed->value, ConstantValue(std::vector<float>{1, 2, 3, 7, 8, 9}));
  const auto part = fold(Op::setComponent, types::color, {Constant::ofInt(2), Constant::ofFloat(0)}, &color);
  EXPECT_EQ(part->value, ConstantValue(std::vector<float>{7, 8, 0}));
  EXPECT_FALSE(fold(Op::setComponent, types::color, {Constant::ofInt(2), Constant::ofFloat(0)}));
}

TEST(Fold, ConvertsAsAssignmentsDo) {
  EXPECT_EQ(convertConstant(Constant::ofInt(3), types::color)->value, ConstantValue(std::vector<float>{3, 3, 3}));
  EXPECT_EQ(std::get<std::vector<float>>(convertConstant(Constant::ofInt(2), types::matrix)->value)[5], 2.0f);
  EXPECT_FALSE(convertConstant(Constant::ofString("x"), types::floating));
  EXPECT_FALSE(convertConstant(Constant{types::color, std::vector<float>{1, 2, 3}}, types::floating));
}

}  // namespace
}  // namespace aerosol::lang

#include "core/app/tools/typed_value.h"

#include <gtest/gtest.h>

namespace aerosol::app {
namespace {

using lang::Type;
namespace types = lang::types;
using Floats = std::vector<float>;
using Ints = std::vector<std::int32_t>;
using Texts = std::vector<std::string>;

TEST(TypedValue, TypesFollowTheText) {
  EXPECT_EQ(inferValue("42").type, types::integer);
  EXPECT_EQ(std::get<Ints>(inferValue("-42").value), Ints{-42});
  EXPECT_EQ(inferValue("42.0").type, types::floating);
  EXPECT_EQ(std::get<Floats>(inferValue("1e-3").value), Floats{1e-3f});
  EXPECT_EQ(inferValue("0.6,0.35,0.99").type, types::vector);
  EXPECT_EQ(inferValue("1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1").type, types::matrix);
  for (const char* text : {"", "grid.tx", "1,2", "1,2,3,4", "4 apples", "0x10"})
    EXPECT_EQ(inferValue(text).type, types::string) << text;
}

TEST(TypedValue, TypesByName) {
  EXPECT_EQ(parseType("color"), types::color);
  EXPECT_EQ(parseType("float[3]"), types::floating.arrayOf(3));
  EXPECT_EQ(parseType("color[]"), types::color.arrayOf(Type::unsized));
  for (const char* text : {"", "flot", "float[", "[]", "float[0]", "float[x]", "float[3"})
    EXPECT_FALSE(parseType(text)) << text;
}

TEST(TypedValue, GivenTypesReadListsAndFillUpWithZeros) {
  EXPECT_EQ(std::get<Floats>(parseValue(types::floating.arrayOf(3), "1,2.5")->value), (Floats{1, 2.5f, 0}));
  EXPECT_EQ(std::get<Ints>(parseValue(types::integer.arrayOf(2), "7, 8")->value), (Ints{7, 8}));
  EXPECT_EQ(std::get<Texts>(parseValue(types::string, "1,2")->value), Texts{"1,2"});
  EXPECT_EQ(std::get<Texts>(parseValue(types::string.arrayOf(2), "a,b")->value), (Texts{"a", "b"}));
  EXPECT_EQ(std::get<Floats>(parseValue(types::floating.arrayOf(3), " 1 2, 3 ")->value), (Floats{1, 2, 3}));
  EXPECT_FALSE(parseValue(types::integer, "1.5"));
  EXPECT_FALSE(parseValue(types::color, "1,2,3,4"));
  EXPECT_FALSE(parseValue(types::floating, "a"));
}

TEST(TypedValue, ArraysWithoutALengthAreAsLongAsTheirValues) {
  const auto floats = parseValue(types::floating.arrayOf(Type::unsized), "1,2,3,4");
  EXPECT_EQ(floats->type, types::floating.arrayOf(4));
  EXPECT_EQ(std::get<Floats>(floats->value), (Floats{1, 2, 3, 4}));
  EXPECT_EQ(parseValue(types::color.arrayOf(Type::unsized), "1 2 3 4 5 6")->type, types::color.arrayOf(2));
  EXPECT_EQ(parseValue(types::color.arrayOf(Type::unsized), "1,2,3,4")->type, types::color.arrayOf(2));
  EXPECT_EQ(std::get<Texts>(parseValue(types::string.arrayOf(Type::unsized), "a,b,c")->value), (Texts{"a", "b", "c"}));
}

TEST(TypedValue, BindsWhatFits) {
  EXPECT_TRUE(bindValue(types::color, inferValue("1,2,3")));
  EXPECT_EQ(std::get<Floats>(*bindValue(types::normal, inferValue("2.0"))), (Floats{2, 2, 2}));
  EXPECT_TRUE(bindValue(types::floating.arrayOf(Type::unsized), *parseValue(types::floating.arrayOf(2), "1,2")));
  EXPECT_FALSE(bindValue(types::floating, inferValue("1")));
  EXPECT_FALSE(bindValue(types::integer, inferValue("1.0")));
  EXPECT_FALSE(bindValue(types::floating.arrayOf(3), inferValue("1,2,3")));
  EXPECT_FALSE(bindValue(types::color.arrayOf(2), inferValue("1.0")));
  EXPECT_FALSE(bindValue(types::closure, inferValue("1,2,3")));
}

}  // namespace
}  // namespace aerosol::app

#include "core/scene/value.h"

#include <gtest/gtest.h>

#include <limits>

namespace aerosol::scene {
namespace {

TEST(ParseFloat, ReadsToTheEnd) {
  TextError error;
  EXPECT_EQ(parseFloat("1.5", error), 1.5f);
  EXPECT_EQ(parseFloat("  -2e-3\n", error), -2e-3f);
  EXPECT_EQ(parseFloat("+4", error), 4.0f);
  EXPECT_EQ(parseFloat("3.4028234e38", error), std::numeric_limits<float>::max());
  for (const char* wrong : {"", " ", "1.5x", "1,5", "0x10", "nan", "-inf", "infinity", "1e39", "1e999", "1 2", "--1",
                            "+-1", "++1", "+", "."}) {
    EXPECT_FALSE(parseFloat(wrong, error)) << wrong;
  }
}

TEST(ParseFloat, TellsTheByte) {
  TextError error;
  EXPECT_FALSE(parseFloat("  12z", error));
  EXPECT_EQ(error.offset, 2u);
  EXPECT_EQ(error.message, "'12z' is not a number");
}

TEST(ParseInteger, FitsInto32Bits) {
  TextError error;
  EXPECT_EQ(parseInteger("-2147483648", error), std::numeric_limits<int>::min());
  EXPECT_EQ(parseInteger(" 7 ", error), 7);
  for (const char* wrong : {"", "2147483648", "1.0", "1e3", "seven", "0x1"})
    EXPECT_FALSE(parseInteger(wrong, error)) << wrong;
}

TEST(ParseBoolean, IsTrueOrFalse) {
  TextError error;
  EXPECT_EQ(parseBoolean("true", error), true);
  EXPECT_EQ(parseBoolean(" False ", error), false);
  for (const char* wrong : {"", "1", "yes", "truee"}) EXPECT_FALSE(parseBoolean(wrong, error)) << wrong;
}

TEST(ParseNumbers, AreSeparatedByBlanksOrSingleCommas) {
  TextError error;
  const std::vector<double> expected = {1, 2, 3};
  for (const char* text : {"1 2 3", "1,2,3", " 1 , 2 ,3 ", "1\t2\n3"})
    EXPECT_EQ(parseNumbers(text, error), expected) << text;
  for (const char* wrong : {"1,,2", ",1", "1,", "1;2", ""}) EXPECT_FALSE(parseNumbers(wrong, error)) << wrong;
  EXPECT_FALSE(parseNumbers("1, 2, x", error));
  EXPECT_EQ(error.offset, 6u);
}

TEST(ParseColor, KnowsGreyTriplesAndHexadecimalSrgb) {
  TextError error;
  EXPECT_EQ(parseColor("0.5", error), Color(0.5f));
  EXPECT_EQ(parseColor("1, 2, 3", error), Color(1, 2, 3));
  const auto c = parseColor("#ff8000", error);
  ASSERT_TRUE(c);
  EXPECT_EQ(c->r, 1.0f);
  EXPECT_NEAR(c->g, 0.2158605f, 1e-6f);
  EXPECT_EQ(c->b, 0.0f);
  for (const char* wrong : {"#fff", "#12345g", "#", "#1234567", "1 2", "1 2 3 4", "red"}) {
    EXPECT_FALSE(parseColor(wrong, error)) << wrong;
  }
}

TEST(ParseMatrix, TakesThreeOrFourRows) {
  TextError error;
  const auto m = parseMatrix("1 2 3 4 5 6 7 8 9", error);
  ASSERT_TRUE(m);
  EXPECT_EQ((*m)[1][2], 6);
  EXPECT_EQ((*m)[3][3], 1);
  EXPECT_EQ((*m)[0][3], 0);
  EXPECT_FALSE(parseMatrix("1 2 3 4", error));
}

TEST(Convert, LosesNothing) {
  EXPECT_EQ(convert(Value(2), ValueType::number), Value(2.0f));
  EXPECT_EQ(convert(Value(0.5f), ValueType::color), Value(Color(0.5f)));
  EXPECT_EQ(convert(Value(true), ValueType::integer), Value(1));
  EXPECT_FALSE(convert(Value(2.0f), ValueType::integer));
  EXPECT_FALSE(convert(Value(1), ValueType::boolean));
  EXPECT_FALSE(convert(Value(Color(1, 2, 3)), ValueType::point));
  EXPECT_FALSE(convert(Value(1), ValueType::string));
}

TEST(Convert, GuessesMoreForUntypedValues) {
  EXPECT_EQ(convert(guessValue("1 2 3"), ValueType::point, true), Value(Point<Unplaced>(1, 2, 3)));
  EXPECT_EQ(convert(guessValue("2"), ValueType::vector, true), Value(Vector<Unplaced>(2, 2, 2)));
  EXPECT_EQ(convert(guessValue("1"), ValueType::boolean, true), Value(true));
  EXPECT_FALSE(convert(guessValue("2"), ValueType::boolean, true));
  EXPECT_EQ(convert(guessValue("12"), ValueType::string, true), Value(std::string("12")));
  EXPECT_FALSE(convert(guessValue("red"), ValueType::color, true));
}

TEST(GuessValue, LooksAtTheText) {
  EXPECT_EQ(typeOf(guessValue("12")), ValueType::integer);
  EXPECT_EQ(typeOf(guessValue("1.5")), ValueType::number);
  EXPECT_EQ(typeOf(guessValue("true")), ValueType::boolean);
  EXPECT_EQ(typeOf(guessValue("#ffffff")), ValueType::color);
  EXPECT_EQ(typeOf(guessValue("1, 2, 3")), ValueType::color);
  EXPECT_EQ(typeOf(guessValue("1 0 0 0 1 0 0 0 1")), ValueType::transform);
  EXPECT_EQ(typeOf(guessValue("perlin")), ValueType::string);
  EXPECT_EQ(typeOf(guessValue("")), ValueType::string);
}

TEST(Format, ReadsBackTheSame) {
  TextError error;
  for (const Value& value :
       {Value(true), Value(-3), Value(0.1f), Value(Color(0.1f, 2, 3e-9f)), Value(Point<Unplaced>(1, 2, 3)),
        Value(Vector<Unplaced>(-1, 0.3f, 0)), Value(identityMatrix()), Value(std::string("a b"))}) {
    EXPECT_EQ(parseValue(typeOf(value), format(value), error), value) << format(value);
  }
}

}  // namespace
}  // namespace aerosol::scene

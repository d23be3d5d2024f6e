#include "core/lang/regex.h"

#include <gtest/gtest.h>

#include <string>

namespace aerosol::lang {
namespace {

TEST(Regex, TakesTimeInProportionToTheText) {
  // Backtracking would take 2^n steps for these.
  const std::string text(2000, 'a');
  for (const char* expression : {"(a*)*b", "(a|aa)+$b", "(a?){50}a{50}b", "(.*)(.*)(.*)x"}) {
    const auto regex = Regex::compile(expression);
    ASSERT_TRUE(regex) << expression;
    EXPECT_FALSE(regex->search(text, false)) << expression;
  }
}

TEST(Regex, RefusesWhatIsMalformedOrTooLong) {
  const std::string deep = std::string(5000, '(') + std::string(5000, ')');
  for (const std::string expression : {"(", ")", "a{2", "a{3,2}", "[", "[]", "[z-a]", "*a", "a\\", "(a)\\1", "[[:no:]]",
                                       "((a{99}){99}){99}", deep.c_str()}) {
    EXPECT_FALSE(Regex::compile(expression)) << expression.substr(0, 20);
  }
}

TEST(Regex, PrefersWhatIsWrittenFirst) {
  const auto first = Regex::compile("a|ab")->search("xab", false);
  ASSERT_TRUE(first);
  EXPECT_EQ((*first)[0], (std::pair<std::int32_t, std::int32_t>(1, 2)));
  const auto whole = Regex::compile("(a|ab)(c|bcd)?")->search("abcd", true);
  ASSERT_TRUE(whole);
  EXPECT_EQ((*whole)[1], (std::pair<std::int32_t, std::int32_t>(0, 1)));
  EXPECT_EQ((*whole)[2], (std::pair<std::int32_t, std::int32_t>(1, 4)));
}

TEST(Regex, EveryByteStringIsAnExpressionOrNot) {
  std::uint32_t state = 1;
  const auto next = [&] { return state = state * 1664525 + 1013904223; };
  for (int i = 0; i < 20000; ++i) {
    std::string expression, text;
    const std::string letters = "ab()[]{}|*+?^$.\\-,:12dwW";
    for (unsigned k = next() >> 28; k > 0; --k) expression += letters[(next() >> 16) % letters.size()];
    for (unsigned k = next() >> 28; k > 0; --k) text += letters[(next() >> 16) % 3];
    const auto regex = Regex::compile(expression);
    if (!regex) continue;
    const auto match = regex->search(text, i % 2 == 0);
    if (!match) continue;
    for (const auto& [begin, end] : *match)
      ASSERT_TRUE((begin == -1 && end == -1) || (begin >= 0 && begin <= end && end <= static_cast<int>(text.size())))
          << expression << " on " << text;
  }
}

}  // namespace
}  // namespace aerosol::lang

#include "core/lang/lexer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace aerosol::lang {
namespace {

struct Lexed {
  TokenStream stream;
  Diagnostics diagnostics;

  const Token& operator[](std::size_t i) const { return stream.tokens.at(i); }
  std::size_t size() const { return stream.tokens.size() - 1; }
  std::string message(std::size_t i) const { return diagnostics.entries().at(i).message; }
};

Lexed lex(const std::string& text) {
  const PreprocessResult source =
      preprocess({.mainFile = "test.osl", .text = text, .includePaths = {}, .defines = {}, .prelude = {}});
  Lexed result;
  result.stream = tokenize(source, result.diagnostics);
  return result;
}

TEST(Lexer, TellsWordsApart) {
  const Lexed tokens = lex("color colour _x1 while double and or not output volume");
  const TokenKind kinds[] = {TokenKind::kwColor,    TokenKind::identifier,  TokenKind::identifier,
                             TokenKind::kwWhile,    TokenKind::reserved,    TokenKind::ampersandAmpersand,
                             TokenKind::pipePipe,   TokenKind::exclamation, TokenKind::kwOutput,
                             TokenKind::identifier, TokenKind::end};
  for (std::size_t i = 0; i < std::size(kinds); ++i) EXPECT_EQ(tokens[i].kind, kinds[i]) << i;
  EXPECT_TRUE(tokens.diagnostics.empty());
}

TEST(Lexer, TellsOperatorsApart) {
  const Lexed tokens = lex("<<= << <= < >>= ++ + += && & &= [[ ]] ... .");
  const TokenKind kinds[] = {TokenKind::shiftLeftAssign,
                             TokenKind::shiftLeft,
                             TokenKind::lessEqual,
                             TokenKind::less,
                             TokenKind::shiftRightAssign,
                             TokenKind::plusPlus,
                             TokenKind::plus,
                             TokenKind::plusAssign,
                             TokenKind::ampersandAmpersand,
                             TokenKind::ampersand,
                             TokenKind::ampersandAssign,
                             TokenKind::leftBracket,
                             TokenKind::leftBracket,
                             TokenKind::rightBracket,
                             TokenKind::rightBracket,
                             TokenKind::ellipsis,
                             TokenKind::period,
                             TokenKind::end};
  for (std::size_t i = 0; i < std::size(kinds); ++i) EXPECT_EQ(tokens[i].kind, kinds[i]) << i;
}

TEST(Lexer, ReadsIntegers) {
  const Lexed tokens = lex("0 42 0x1F 0XfF 017 2147483647 0xffffffff 0x80000000");
  const std::int64_t values[] = {0, 42, 31, 255, 17, 2147483647, -1, std::numeric_limits<std::int32_t>::min()};
  ASSERT_EQ(tokens.size(), std::size(values));
  for (std::size_t i = 0; i < std::size(values); ++i) {
    EXPECT_EQ(tokens[i].kind, TokenKind::intLiteral);
    EXPECT_EQ(tokens[i].integer, values[i]) << i;
  }
  EXPECT_TRUE(tokens.diagnostics.empty());
}

TEST(Lexer, RefusesIntegersThatDoNotFit) {
  for (const char* text : {"2147483649", "99999999999999999999999", "0x100000000", "0040000000000"}) {
    const Lexed tokens = lex(text);
    ASSERT_EQ(tokens.diagnostics.errorCount(), 1) << text;
    EXPECT_EQ(tokens.message(0), "the integer " + std::string(text) + " is too large: int has 32 bits");
    EXPECT_EQ(tokens[0].kind, TokenKind::intLiteral);
  }
  EXPECT_EQ(lex("089")[0].integer, 89);  // A zero in front has no meaning.
}

TEST(Lexer, ReadsFloats) {
  const Lexed tokens = lex("1. .5 1e3 1.5e-2 2.f 3.25F 1E+2 0.0 1e-60");
  const float values[] = {1.0f, 0.5f, 1000.0f, 0.015f, 2.0f, 3.25f, 100.0f, 0.0f, 0.0f};
  ASSERT_EQ(tokens.size(), std::size(values));
  for (std::size_t i = 0; i < std::size(values); ++i) {
    EXPECT_EQ(tokens[i].kind, TokenKind::floatLiteral);
    EXPECT_EQ(tokens[i].floating, values[i]) << i;
  }
  EXPECT_TRUE(tokens.diagnostics.empty());
}

TEST(Lexer, WarnsOfInfiniteFloats) {
  for (const char* text : {"1e39", "1e999"}) {
    const Lexed tokens = lex(text);
    EXPECT_TRUE(std::isinf(tokens[0].floating));
    ASSERT_EQ(tokens.diagnostics.entries().size(), 1u);
    EXPECT_EQ(tokens.diagnostics.entries()[0].severity, Severity::warning);
  }
}

TEST(Lexer, RefusesMalformedNumbers) {
  for (const char* text : {"1x", "1.5.2", "1f", "0x", "0xg", "1e", "1e+", "0x1p3", "1u", "1.0l"}) {
    const Lexed tokens = lex(text);
    ASSERT_EQ(tokens.diagnostics.errorCount(), 1) << text;
    EXPECT_TRUE(tokens.message(0).starts_with("'" + std::string(text) + "' is not a number")) << tokens.message(0);
  }
}

TEST(Lexer, SplitsHexadecimalNumbersFromSigns) {
  const Lexed tokens = lex("0x1e+1 0xE-n 0x1e-0x2e+3");
  const TokenKind kinds[] = {TokenKind::intLiteral, TokenKind::plus,       TokenKind::intLiteral, TokenKind::intLiteral,
                             TokenKind::minus,      TokenKind::identifier, TokenKind::intLiteral, TokenKind::minus,
                             TokenKind::intLiteral, TokenKind::plus,       TokenKind::intLiteral, TokenKind::end};
  for (std::size_t i = 0; i < std::size(kinds); ++i) EXPECT_EQ(tokens[i].kind, kinds[i]) << i;
  EXPECT_EQ(tokens[8].integer, 0x2e);
  EXPECT_TRUE(tokens.diagnostics.empty());
}

TEST(Lexer, JoinsStringsAndResolvesEscapes) {
  const Lexed tokens = lex(R"("a\n" "\101\102" "\\\"" "" x "z" "y\0lost" "\7")");
  ASSERT_EQ(tokens.size(), 3u);
  EXPECT_EQ(tokens.stream.strings[tokens[0].string], "a\nAB\\\"");
  EXPECT_EQ(tokens.stream.strings[tokens[2].string], "zy\a");  // A zero ends its literal.
  EXPECT_TRUE(tokens.diagnostics.empty());
}

TEST(Lexer, KeepsUnknownEscapesWithAWarning) {
  const Lexed tokens = lex(R"("\.%\x41\'\?\e")");
  EXPECT_EQ(tokens.stream.strings[tokens[0].string], "\\.%\\x41\\'\\?\\e");
  ASSERT_EQ(tokens.diagnostics.entries().size(), 5u);
  EXPECT_EQ(tokens.diagnostics.entries()[0].severity, Severity::warning);
}

TEST(Lexer, RefusesBadStringsAndCharacters) {
  const std::pair<const char*, const char*> cases[] = {
      {"\"abc", "this string does not end on its line: a '\"' is missing"},
      {"'c'", "character constant 'c': strings stand in double quotes"},
      {"'c", "this character constant does not end on its line; strings stand in double quotes"},
      {"L\"x\"", "the prefix of the string L\"x\" is not part of the language"},
      {"\"\\777\"", "the escape '\\777' is not a character"},
      {"@", "stray '@'"},
      {"`", "stray '`'"},
      {"a$", "stray '$'"},
      {"->", "'->' is not an operator of the language"},
      {"caf\xc3\xa9",
       "the name 'caf\xc3\xa9' has a character that is not a letter of the Latin alphabet, a digit or '_'"},
  };
  for (const auto& [text, message] : cases) {
    const Lexed tokens = lex(text);
    ASSERT_EQ(tokens.diagnostics.errorCount(), 1) << text;
    EXPECT_EQ(tokens.message(0), message);
  }
}

TEST(Lexer, LocatesItsErrors) {
  const Lexed tokens = lex("int a;\n  float b = 'c';\n");
  EXPECT_EQ(tokens.diagnostics.entries().at(0).location, (SourceLocation{"test.osl", 2, 13}));
  EXPECT_EQ(tokens.diagnostics.entries().at(0).sourceLine, "  float b = 'c';");
}

}  // namespace
}  // namespace aerosol::lang

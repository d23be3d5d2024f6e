#include "core/lang/token.h"

#include <algorithm>
#include <array>
#include <unordered_map>

namespace aerosol::lang {

namespace {

struct Spelling {
  TokenKind kind;
  std::string_view text;
};

constexpr Spelling keywords[] = {
    {TokenKind::kwBreak, "break"},
    {TokenKind::kwClosure, "closure"},
    {TokenKind::kwColor, "color"},
    {TokenKind::kwContinue, "continue"},
    {TokenKind::kwDo, "do"},
    {TokenKind::kwElse, "else"},
    {TokenKind::kwFloat, "float"},
    {TokenKind::kwFor, "for"},
    {TokenKind::kwIf, "if"},
    {TokenKind::kwIlluminance, "illuminance"},
    {TokenKind::kwIlluminate, "illuminate"},
    {TokenKind::kwInt, "int"},
    {TokenKind::kwMatrix, "matrix"},
    {TokenKind::kwNormal, "normal"},
    {TokenKind::kwOutput, "output"},
    {TokenKind::kwPoint, "point"},
    {TokenKind::kwPublic, "public"},
    {TokenKind::kwReturn, "return"},
    {TokenKind::kwString, "string"},
    {TokenKind::kwStruct, "struct"},
    {TokenKind::kwVector, "vector"},
    {TokenKind::kwVoid, "void"},
    {TokenKind::kwWhile, "while"},
    // Words for operators.
    {TokenKind::ampersandAmpersand, "and"},
    {TokenKind::pipePipe, "or"},
    {TokenKind::exclamation, "not"},
};

constexpr Spelling punctuation[] = {
    {TokenKind::leftParen, "("},
    {TokenKind::rightParen, ")"},
    {TokenKind::leftBrace, "{"},
    {TokenKind::rightBrace, "}"},
    {TokenKind::leftBracket, "["},
    {TokenKind::rightBracket, "]"},
    {TokenKind::comma, ","},
    {TokenKind::semicolon, ";"},
    {TokenKind::colon, ":"},
    {TokenKind::question, "?"},
    {TokenKind::period, "."},
    {TokenKind::ellipsis, "..."},
    {TokenKind::plus, "+"},
    {TokenKind::minus, "-"},
    {TokenKind::star, "*"},
    {TokenKind::slash, "/"},
    {TokenKind::percent, "%"},
    {TokenKind::ampersand, "&"},
    {TokenKind::pipe, "|"},
    {TokenKind::caret, "^"},
    {TokenKind::tilde, "~"},
    {TokenKind::exclamation, "!"},
    {TokenKind::plusPlus, "++"},
    {TokenKind::minusMinus, "--"},
    {TokenKind::shiftLeft, "<<"},
    {TokenKind::shiftRight, ">>"},
    {TokenKind::less, "<"},
    {TokenKind::lessEqual, "<="},
    {TokenKind::greater, ">"},
    {TokenKind::greaterEqual, ">="},
    {TokenKind::equalEqual, "=="},
    {TokenKind::notEqual, "!="},
    {TokenKind::ampersandAmpersand, "&&"},
    {TokenKind::pipePipe, "||"},
    {TokenKind::assign, "="},
    {TokenKind::plusAssign, "+="},
    {TokenKind::minusAssign, "-="},
    {TokenKind::starAssign, "*="},
    {TokenKind::slashAssign, "/="},
    {TokenKind::percentAssign, "%="},
    {TokenKind::ampersandAssign, "&="},
    {TokenKind::pipeAssign, "|="},
    {TokenKind::caretAssign, "^="},
    {TokenKind::shiftLeftAssign, "<<="},
    {TokenKind::shiftRightAssign, ">>="},
};

/// The specification reserves a few more (catch, delete, goto, new, operator, throw, try, volatile; emit as a keyword),
/// which oslc takes as names.
constexpr std::string_view reservedWords[] = {
    "bool",     "case",   "char", "class",   "const",     "default", "double",   "enum",    "extern",  "false",
    "friend",   "inline", "long", "private", "protected", "short",   "signed",   "sizeof",  "static",  "switch",
    "template", "this",   "true", "typedef", "uniform",   "union",   "unsigned", "varying", "virtual",
};

std::unordered_map<std::string_view, TokenKind> makeWords() {
  std::unordered_map<std::string_view, TokenKind> words;
  for (const auto& [kind, text] : keywords) words.emplace(text, kind);
  for (const std::string_view text : reservedWords) words.emplace(text, TokenKind::reserved);
  return words;
}

std::unordered_map<std::string_view, TokenKind> makePunctuators() {
  std::unordered_map<std::string_view, TokenKind> punctuators;
  for (const auto& [kind, text] : punctuation) punctuators.emplace(text, kind);
  return punctuators;
}

}  // namespace

TokenKind wordKind(std::string_view word) {
  static const auto words = makeWords();
  const auto found = words.find(word);
  return found == words.end() ? TokenKind::identifier : found->second;
}

TokenKind punctuatorKind(std::string_view text) {
  static const auto punctuators = makePunctuators();
  const auto found = punctuators.find(text);
  return found == punctuators.end() ? TokenKind::invalid : found->second;
}

std::string describe(TokenKind kind) {
  switch (kind) {
    case TokenKind::end:
      return "end of file";
    case TokenKind::identifier:
      return "a name";
    case TokenKind::intLiteral:
      return "an integer";
    case TokenKind::floatLiteral:
      return "a number";
    case TokenKind::stringLiteral:
      return "a string";
    case TokenKind::reserved:
      return "a reserved word";
    case TokenKind::invalid:
      return "an invalid token";
    default:
      break;
  }
  for (const auto& spelling : punctuation) {
    if (spelling.kind == kind) return "'" + std::string(spelling.text) + "'";
  }
  for (const auto& spelling : keywords) {
    if (spelling.kind == kind) return "'" + std::string(spelling.text) + "'";
  }
  return "a token";
}

std::string describe(const Token& token) {
  constexpr std::size_t longest = 40;
  switch (token.kind) {
    case TokenKind::end:
      return "the end of the file";
    case TokenKind::stringLiteral:
      return token.text.size() > longest ? "a string" : "the string " + std::string(token.text);
    default:
      if (token.text.starts_with('\'') && token.text.size() <= longest) return std::string(token.text);
      return "'" + std::string(token.text.substr(0, longest)) + (token.text.size() > longest ? "…'" : "'");
  }
}

}  // namespace aerosol::lang

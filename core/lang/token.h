// The words of the language.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/lang/ast.h"

namespace aerosol::lang {

enum class TokenKind : std::uint8_t {
  end,
  identifier,
  intLiteral,
  floatLiteral,
  stringLiteral,
  reserved,  ///< A word that the language keeps for itself and gives no meaning.
  invalid,   ///< Something that the lexer has already complained about.
  // Keywords
  kwBreak,
  kwClosure,
  kwColor,
  kwContinue,
  kwDo,
  kwElse,
  kwFloat,
  kwFor,
  kwIf,
  kwIlluminance,
  kwIlluminate,
  kwInt,
  kwMatrix,
  kwNormal,
  kwOutput,
  kwPoint,
  kwPublic,
  kwReturn,
  kwString,
  kwStruct,
  kwVector,
  kwVoid,
  kwWhile,
  // Punctuation. `[[` and `]]` are two tokens each: the parser tells metadata from nested indices.
  leftParen,
  rightParen,
  leftBrace,
  rightBrace,
  leftBracket,
  rightBracket,
  comma,
  semicolon,
  colon,
  question,
  period,
  ellipsis,
  plus,
  minus,
  star,
  slash,
  percent,
  ampersand,
  pipe,
  caret,
  tilde,
  exclamation,
  plusPlus,
  minusMinus,
  shiftLeft,
  shiftRight,
  less,
  lessEqual,
  greater,
  greaterEqual,
  equalEqual,
  notEqual,
  ampersandAmpersand,
  pipePipe,
  assign,
  plusAssign,
  minusAssign,
  starAssign,
  slashAssign,
  percentAssign,
  ampersandAssign,
  pipeAssign,
  caretAssign,
  shiftLeftAssign,
  shiftRightAssign,
};

struct Token {
  TokenKind kind = TokenKind::end;
  Position position = 0;
  std::string_view text;  ///< As written; of joined strings, the first one.
  union {
    std::int64_t integer = 0;  ///< At most 2^31 for decimal literals (2^31 itself only makes sense behind a minus).
    float floating;
    std::uint32_t string;  ///< Index into `TokenStream::strings`.
  };
};

struct TokenStream {
  std::vector<Token> tokens;  ///< The last one is `end`.
  std::vector<std::string> strings;
  std::shared_ptr<const void> storage;  ///< Owns what the tokens' texts view.
};

/// Keywords and reserved words: their kind; anything else is an identifier.
TokenKind wordKind(std::string_view word);

/// Operators and brackets: their kind; `invalid` for anything else.
TokenKind punctuatorKind(std::string_view text);

/// How the kind is named in messages: "a name", "';'", "'while'".
std::string describe(TokenKind kind);
/// What was found, as written: "';'", "'foo'", "the end of the file".
std::string describe(const Token& token);

}  // namespace aerosol::lang

#include "core/lang/lexer.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

namespace aerosol::lang {

namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isHexDigit(char c) { return isDigit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }
bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

std::size_t countDigits(std::string_view text, std::size_t from) {
  std::size_t end = from;
  while (end < text.size() && isDigit(text[end])) ++end;
  return end - from;
}

/// The value of a well-formed decimal number. What is too large becomes infinite, what is too small zero.
float toFloat(std::string_view text) {
  float value = 0;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data(), end, value).ec == std::errc()) return value;
  double wide = 0;
  if (std::from_chars(text.data(), end, wide).ec == std::errc()) return static_cast<float>(wide);
  const std::size_t exponent = text.find_first_of("eE");
  const bool tiny = exponent != std::string_view::npos ? text.find('-', exponent) != std::string_view::npos
                                                       : text.starts_with("0") || text.starts_with(".");
  return tiny ? 0.0f : std::numeric_limits<float>::infinity();
}

class Lexer {
 public:
  Lexer(const PreprocessResult& source, Diagnostics& diagnostics)
      : source_(source), map_(*source.sourceMap), diagnostics_(diagnostics) {}

  TokenStream run() {
    stream_.storage = source_.storage;
    stream_.tokens.reserve(source_.tokens.size() + 1);
    for (; index_ < source_.tokens.size() && !full(); ++index_) token(source_.tokens[index_]);
    add(TokenKind::end, {}, source_.end);
    return std::move(stream_);
  }

 private:
  bool full() const { return diagnostics_.errorCount() >= maximumErrors; }

  Token& add(TokenKind kind, std::string_view text, Position position) {
    Token token;
    token.kind = kind;
    token.text = text;
    token.position = position;
    stream_.tokens.push_back(token);
    return stream_.tokens.back();
  }

  void error(Position position, std::string message, std::vector<std::string> notes = {}) {
    if (!full()) diagnostics_.add(map_.error(position, std::move(message), std::move(notes)));
  }

  void warning(Position position, std::string message) {
    if (!map_.warningsSuppressed(position)) diagnostics_.add(map_.warning(position, std::move(message)));
  }

  void token(const PpToken& token) {
    switch (token.kind) {
      case PpTokenKind::identifier:
        word(token);
        break;
      case PpTokenKind::number:
        number(token.text, token.position);
        break;
      case PpTokenKind::string:
        strings();
        break;
      case PpTokenKind::character: {
        error(token.position, fmt::format("character constant {}: strings stand in double quotes", token.text));
        add(TokenKind::intLiteral, token.text, token.position).integer = 0;
        break;
      }
      case PpTokenKind::punctuator:
        punctuator(token);
        break;
      case PpTokenKind::unknown:
        unknown(token);
        break;
    }
  }

  void word(const PpToken& token) {
    for (const char c : token.text) {
      if (!isLetter(c) && !isDigit(c)) {
        error(token.position,
              fmt::format("the name '{}' has a character that is not a letter of the Latin alphabet, a digit or '_'",
                          token.text));
        break;
      }
    }
    add(wordKind(token.text), token.text, token.position);
  }

  void punctuator(const PpToken& token) {
    const TokenKind kind = punctuatorKind(token.text);
    if (kind == TokenKind::invalid) {
      error(token.position, fmt::format("'{}' is not an operator of the language", token.text));
    }
    add(kind, token.text, token.position);
  }

  void unknown(const PpToken& token) {
    if (token.text.starts_with('"')) {
      error(token.position, "this string does not end on its line: a '\"' is missing");
      addString(token.text, token.position, {});
      add(TokenKind::invalid, token.text, token.position);  // The rest of the line is lost.
    } else if (token.text.starts_with('\'')) {
      error(token.position, "this character constant does not end on its line; strings stand in double quotes");
      add(TokenKind::intLiteral, token.text, token.position).integer = 0;
      add(TokenKind::invalid, token.text, token.position);
    } else if (token.text.size() == 1 && token.text[0] > ' ' && token.text[0] < 127) {
      error(token.position, fmt::format("stray '{}'", token.text));
      add(TokenKind::invalid, token.text, token.position);
    } else {
      const auto byte = token.text.empty() ? 0u : static_cast<unsigned char>(token.text[0]);
      error(token.position, fmt::format("stray byte 0x{:02x}", byte));
      add(TokenKind::invalid, token.text, token.position);
    }
  }

  // Numbers -----------------------------------------------------------------------------------------------------------

  /// C's preprocessor lets a sign cling to a hexadecimal number that ends in e, as in `0x1e+1`; here that is a sum.
  static std::size_t hexLength(std::string_view text) {
    std::size_t length = 2;
    while (length < text.size() && isHexDigit(text[length])) ++length;
    return length;
  }

  void number(std::string_view text, Position position) {
    const bool hex = text.size() >= 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    if (hex) {
      const std::size_t length = hexLength(text);
      if (length > 2 && length < text.size() && (text[length] == '+' || text[length] == '-')) {
        integer(text.substr(0, length), 2, 16, position);
        add(text[length] == '+' ? TokenKind::plus : TokenKind::minus, text.substr(length, 1), position);
        const std::string_view rest = text.substr(length + 1);
        if (rest.empty()) return;
        if (isLetter(rest[0])) return word({PpTokenKind::identifier, rest, position});
        return number(rest, position);
      }
      if (length == text.size() && length > 2) return integer(text, 2, 16, position);
      return malformed(text, position);
    }
    if (countDigits(text, 0) == text.size()) {
      return integer(text, 0, 10, position);  // A zero in front has no meaning.
    }
    floating(text, position);
  }

  void integer(std::string_view text, std::size_t prefix, int base, Position position) {
    std::uint64_t value = 0;
    const char* end = text.data() + text.size();
    const std::errc problem = std::from_chars(text.data() + prefix, end, value, base).ec;
    std::int64_t result = 0;
    if (problem != std::errc() || value > (base == 10 ? 0x80000000u : 0xffffffffu)) {
      error(position, fmt::format("the integer {} is too large: int has 32 bits", text));
    } else {
      // Hexadecimal numbers give the bits of the int.
      result =
          base == 10 ? static_cast<std::int64_t>(value) : static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
    }
    add(TokenKind::intLiteral, text, position).integer = result;
  }

  void floating(std::string_view text, Position position) {
    std::size_t at = countDigits(text, 0);
    std::size_t digits = at;
    bool real = false;
    if (at < text.size() && text[at] == '.') {
      const std::size_t decimals = countDigits(text, ++at);
      digits += decimals;
      at += decimals;
      real = true;
    }
    if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
      std::size_t exponent = at + 1;
      if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
      const std::size_t count = countDigits(text, exponent);
      if (count == 0) return malformed(text, position, "its exponent has no digits");
      at = exponent + count;
      real = true;
    }
    const std::string_view value = text.substr(0, at);
    if (real && at < text.size() && (text[at] == 'f' || text[at] == 'F')) ++at;
    if (digits == 0 || !real || at != text.size()) return malformed(text, position);
    const float result = toFloat(value);
    if (std::isinf(result))
      warning(position, fmt::format("{} is larger than a float can be: it becomes infinite", text));
    add(TokenKind::floatLiteral, text, position).floating = result;
  }

  void malformed(std::string_view text, Position position, std::string_view why = "") {
    error(position, fmt::format("'{}' is not a number{}{}", text, why.empty() ? "" : ": ", why));
    add(TokenKind::floatLiteral, text, position).floating = 0;
  }

  // Strings -----------------------------------------------------------------------------------------------------------

  void addString(std::string_view text, Position position, std::string value) {
    add(TokenKind::stringLiteral, text, position).string = static_cast<std::uint32_t>(stream_.strings.size());
    stream_.strings.push_back(std::move(value));
  }

  void strings() {
    const PpToken& first = source_.tokens[index_];
    std::string value;
    while (true) {
      const PpToken& token = source_.tokens[index_];
      contents(token, value);
      if (index_ + 1 >= source_.tokens.size() || source_.tokens[index_ + 1].kind != PpTokenKind::string) break;
      ++index_;
    }
    addString(first.text, first.position, std::move(value));
  }

  void contents(const PpToken& token, std::string& value) {
    std::string_view text = token.text;
    if (!text.starts_with('"') || text.size() < 2 || !text.ends_with('"')) {
      error(token.position, fmt::format("the prefix of the string {} is not part of the language", text));
      return;
    }
    text = text.substr(1, text.size() - 2);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\\' && i + 1 < text.size()) {
        i = escape(text, i + 1, token.position, value);
      } else {
        value += text[i];
      }
    }
  }

  /// Appends what the escape at `at` (behind the backslash) stands for; returns the index of its last character.
  std::size_t escape(std::string_view text, std::size_t at, Position position, std::string& value) {
    constexpr std::string_view names = "abfnrtv\\\"";
    constexpr std::string_view meanings = "\a\b\f\n\r\t\v\\\"";
    if (const std::size_t found = names.find(text[at]); found != std::string_view::npos) {
      value += meanings[found];
      return at;
    }
    const auto isOctal = [](char c) { return c >= '0' && c <= '7'; };
    if (!isOctal(text[at])) {
      warning(position, fmt::format("unknown escape '\\{}' in a string: the backslash is kept", text[at]));
      value += '\\';
      value += text[at];
      return at;
    }
    std::size_t end = at;
    while (end < text.size() && end < at + 3 && isOctal(text[end])) ++end;
    unsigned code = 0;
    std::from_chars(text.data() + at, text.data() + end, code, 8);
    if (code == 0) return text.size();  // A string ends at its first zero.
    if (code > 255) error(position, fmt::format("the escape '\\{}' is not a character", text.substr(at, end - at)));
    value += static_cast<char>(code & 255u);
    return end - 1;
  }

  const PreprocessResult& source_;
  const SourceMap& map_;
  Diagnostics& diagnostics_;
  TokenStream stream_;
  std::size_t index_ = 0;
};

}  // namespace

TokenStream tokenize(const PreprocessResult& source, Diagnostics& diagnostics) {
  return Lexer(source, diagnostics).run();
}

}  // namespace aerosol::lang

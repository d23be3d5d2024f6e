#include "core/scene/value.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace aerosol::scene {

namespace {

constexpr std::string_view blanks = " \t\r\n";

bool isBlank(char c) { return blanks.find(c) != std::string_view::npos; }

/// Long or binary input shall not flood a message.
std::string quoted(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 40)) shown += std::iscntrl(static_cast<unsigned char>(c)) ? '?' : c;
  return fmt::format("'{}{}'", shown, text.size() > 40 ? "…" : "");
}

/// What from_chars reads, but with an optional plus sign.
std::string_view withoutPlus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+';
  return plus ? text.substr(1) : text;
}

std::size_t leadingBlanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string_view::npos ? 0 : first;
}

float decodeSrgb(int byte) {
  const double v = byte / 255.0;
  return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<Color> parseHexColor(std::string_view digits, std::size_t offset, TextError& error) {
  int bytes[3] = {0, 0, 0};
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const int digit = hexDigit(digits[i]);
    if (digit < 0) {
      error = {offset + 1 + i, fmt::format("{} is not a hexadecimal digit", quoted(digits.substr(i, 1)))};
      return std::nullopt;
    }
    if (i < 6) bytes[i / 2] = bytes[i / 2] * 16 + digit;
  }
  if (digits.size() != 6) {
    error = {offset, fmt::format("a colour after '#' has 6 hexadecimal digits, this one has {}", digits.size())};
    return std::nullopt;
  }
  return Color(decodeSrgb(bytes[0]), decodeSrgb(bytes[1]), decodeSrgb(bytes[2]));
}

template <class T>
std::optional<T> triple(std::string_view text, TextError& error) {
  const auto v = parseTriple(text, error);
  if (!v) return std::nullopt;
  return T((*v)[0], (*v)[1], (*v)[2]);
}

template <class T>
std::optional<Value> asValue(std::optional<T> parsed) {
  if (!parsed) return std::nullopt;
  return Value(std::in_place_type<T>, std::move(*parsed));
}

struct Formatter {
  std::string operator()(bool v) const { return v ? "true" : "false"; }
  std::string operator()(int v) const { return fmt::format("{}", v); }
  std::string operator()(float v) const { return fmt::format("{}", v); }
  std::string operator()(const std::string& v) const { return v; }
  std::string operator()(Color v) const { return fmt::format("{} {} {}", v.r, v.g, v.b); }
  std::string operator()(Point<Unplaced> v) const { return fmt::format("{} {} {}", v.x, v.y, v.z); }
  std::string operator()(Vector<Unplaced> v) const { return fmt::format("{} {} {}", v.x, v.y, v.z); }
  std::string operator()(const Matrix4& m) const {
    std::string text;
    for (const auto& row : m) {
      for (const double v : row) text += fmt::format("{}{}", text.empty() ? "" : " ", v);
    }
    return text;
  }
};

std::optional<Value> convertUntyped(const Value& value, ValueType type) {
  if (type == ValueType::string) return Value(format(value));
  const int* integer = std::get_if<int>(&value);
  if (type == ValueType::boolean && integer && (*integer == 0 || *integer == 1)) return Value(*integer == 1);
  const std::optional<Value> color = convert(value, ValueType::color);
  if (!color) return std::nullopt;
  const Color c = std::get<Color>(*color);
  if (type == ValueType::point) return Value(Point<Unplaced>(c.r, c.g, c.b));
  if (type == ValueType::vector) return Value(Vector<Unplaced>(c.r, c.g, c.b));
  return std::nullopt;
}

}  // namespace

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view name(ValueType type) {
  switch (type) {
    case ValueType::boolean:
      return "boolean";
    case ValueType::integer:
      return "integer";
    case ValueType::number:
      return "float";
    case ValueType::string:
      return "string";
    case ValueType::color:
      return "rgb";
    case ValueType::point:
      return "point";
    case ValueType::vector:
      return "vector";
    case ValueType::transform:
      break;
  }
  return "transform";
}

std::string format(const Value& value) { return std::visit(Formatter{}, value); }

std::optional<Value> convert(const Value& value, ValueType type, bool untyped) {
  const ValueType from = typeOf(value);
  if (from == type) return value;
  if (from == ValueType::integer && type == ValueType::number) return Value(static_cast<float>(std::get<int>(value)));
  if (from == ValueType::boolean && type == ValueType::integer) return Value(std::get<bool>(value) ? 1 : 0);
  if (type == ValueType::color && (from == ValueType::number || from == ValueType::integer)) {
    const float grey = from == ValueType::number ? std::get<float>(value) : static_cast<float>(std::get<int>(value));
    return Value(Color(grey));
  }
  return untyped ? convertUntyped(value, type) : std::nullopt;
}

std::optional<double> parseNumber(std::string_view text, TextError& error) {
  const std::size_t offset = leadingBlanks(text);
  const std::string_view whole = trim(text);
  if (whole.empty()) {
    error = {0, "a number is missing: the text is empty"};
    return std::nullopt;
  }
  const std::string_view digits = withoutPlus(whole);
  double number = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (code == std::errc::result_out_of_range) {
    error = {offset, fmt::format("{} is too large or too small for a number", quoted(whole))};
    return std::nullopt;
  }
  if (code != std::errc{} || end != digits.data() + digits.size()) {
    error = {offset, fmt::format("{} is not a number", quoted(whole))};
    return std::nullopt;
  }
  if (!std::isfinite(number)) {
    error = {offset, fmt::format("{} is not a finite number", quoted(whole))};
    return std::nullopt;
  }
  return number;
}

std::optional<float> parseFloat(std::string_view text, TextError& error) {
  const std::optional<double> number = parseNumber(text, error);
  if (!number) return std::nullopt;
  if (std::fabs(*number) > static_cast<double>(std::numeric_limits<float>::max())) {
    error = {leadingBlanks(text), fmt::format("{} is too large for a number", quoted(trim(text)))};
    return std::nullopt;
  }
  return static_cast<float>(*number);
}

std::optional<int> parseInteger(std::string_view text, TextError& error) {
  const std::size_t offset = leadingBlanks(text);
  const std::string_view whole = trim(text);
  if (whole.empty()) {
    error = {0, "an integer is missing: the text is empty"};
    return std::nullopt;
  }
  const std::string_view digits = withoutPlus(whole);
  int number = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (end == digits.data() + digits.size() && code == std::errc::result_out_of_range) {
    error = {offset, fmt::format("{} does not fit into 32 bits", quoted(whole))};
    return std::nullopt;
  }
  if (code != std::errc{} || end != digits.data() + digits.size()) {
    error = {offset, fmt::format("{} is not an integer", quoted(whole))};
    return std::nullopt;
  }
  return number;
}

std::optional<bool> parseBoolean(std::string_view text, TextError& error) {
  std::string word(trim(text));
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (word == "true") return true;
  if (word == "false") return false;
  error = {leadingBlanks(text), fmt::format("{} is not a boolean: write true or false", quoted(trim(text)))};
  return std::nullopt;
}

std::optional<std::vector<double>> parseNumbers(std::string_view text, TextError& error) {
  std::vector<double> numbers;
  std::size_t i = 0;
  const auto skipBlanks = [&] {
    while (i < text.size() && isBlank(text[i])) ++i;
  };
  skipBlanks();
  while (i < text.size()) {
    const std::size_t start = i;
    while (i < text.size() && !isBlank(text[i]) && text[i] != ',') ++i;
    if (i == start) {
      error = {start, "a number is missing before ','"};
      return std::nullopt;
    }
    const std::optional<double> number = parseNumber(text.substr(start, i - start), error);
    if (!number) {
      error.offset += start;
      return std::nullopt;
    }
    numbers.push_back(*number);
    skipBlanks();
    if (i < text.size() && text[i] == ',') {
      ++i;
      skipBlanks();
      if (i == text.size()) {
        error = {i - 1, "a number is missing after ','"};
        return std::nullopt;
      }
    }
  }
  if (numbers.empty()) {
    error = {0, "numbers are missing: the text is empty"};
    return std::nullopt;
  }
  return numbers;
}

std::optional<std::vector<float>> parseTriple(std::string_view text, TextError& error) {
  const auto numbers = parseNumbers(text, error);
  if (!numbers) return std::nullopt;
  if (numbers->size() != 1 && numbers->size() != 3) {
    error = {leadingBlanks(text), fmt::format("1 or 3 numbers are needed, not {}", numbers->size())};
    return std::nullopt;
  }
  std::vector<float> values;
  for (const double n : *numbers) {
    if (std::fabs(n) > static_cast<double>(std::numeric_limits<float>::max())) {
      error = {leadingBlanks(text), fmt::format("{} is too large for a number", n)};
      return std::nullopt;
    }
    values.push_back(static_cast<float>(n));
  }
  if (values.size() == 1) values.resize(3, values[0]);
  return values;
}

std::optional<Color> parseColor(std::string_view text, TextError& error) {
  const std::string_view whole = trim(text);
  if (!whole.empty() && whole[0] == '#') return parseHexColor(whole.substr(1), leadingBlanks(text), error);
  return triple<Color>(text, error);
}

std::optional<Matrix4> parseMatrix(std::string_view text, TextError& error) {
  const auto numbers = parseNumbers(text, error);
  if (!numbers) return std::nullopt;
  if (numbers->size() != 9 && numbers->size() != 16) {
    error = {leadingBlanks(text), fmt::format("a matrix has 16 or 9 numbers, not {}", numbers->size())};
    return std::nullopt;
  }
  const std::size_t n = numbers->size() == 16 ? 4 : 3;
  Matrix4 matrix = identityMatrix();
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t column = 0; column < n; ++column) matrix[row][column] = (*numbers)[row * n + column];
  }
  return matrix;
}

std::optional<Value> parseValue(ValueType type, std::string_view text, TextError& error) {
  switch (type) {
    case ValueType::boolean:
      return asValue(parseBoolean(text, error));
    case ValueType::integer:
      return asValue(parseInteger(text, error));
    case ValueType::number:
      return asValue(parseFloat(text, error));
    case ValueType::string:
      return Value(std::string(text));
    case ValueType::color:
      return asValue(parseColor(text, error));
    case ValueType::point:
      return asValue(triple<Point<Unplaced>>(text, error));
    case ValueType::vector:
      return asValue(triple<Vector<Unplaced>>(text, error));
    case ValueType::transform:
      break;
  }
  return asValue(parseMatrix(text, error));
}

Value guessValue(std::string_view text) {
  TextError ignored;
  if (const auto v = parseInteger(text, ignored)) return *v;
  if (const auto v = parseFloat(text, ignored)) return *v;
  if (const auto v = parseBoolean(text, ignored)) return *v;
  if (const auto v = parseColor(text, ignored)) return *v;
  if (const auto v = parseMatrix(text, ignored)) return *v;
  return std::string(text);
}

}  // namespace aerosol::scene

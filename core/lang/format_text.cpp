#include "core/lang/format_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace aerosol::lang {

namespace {

constexpr std::string_view flags = "-+ #0";
constexpr std::string_view digits = "0123456789";
constexpr std::string_view integerConversions = "dioxXcu";
constexpr std::string_view floatingConversions = "fFeEgGaA";
constexpr std::string_view tripleConversions = "pnvm";  // Of older shaders, for points and the like: as %g.
constexpr std::string_view lengths = "hlLqjzt";         // Sizes of C's types, which mean nothing here.
constexpr int maximumWidth = 1000;

bool contains(std::string_view set, char c) { return set.find(c) != std::string_view::npos; }

int numberAt(std::string_view text, std::size_t& i) {
  int number = 0;
  for (; i < text.size() && contains(digits, text[i]); ++i)
    number = std::min(number * 10 + (text[i] - '0'), maximumWidth);
  return number;
}

/// Length of the conversion that begins with the percent sign at the front; 0 when there is none that is whole.
std::size_t conversionLength(std::string_view text) {
  std::size_t i = 1;
  while (i < text.size() && contains(flags, text[i])) ++i;
  numberAt(text, i);
  if (i < text.size() && text[i] == '.') numberAt(text, ++i);
  while (i < text.size() && contains(lengths, text[i])) ++i;
  if (i == text.size()) return 0;
  const char c = text[i];
  return contains(integerConversions, c) || contains(floatingConversions, c) || contains(tripleConversions, c) ||
                 c == 's'
             ? i + 1
             : 0;
}

template <class T>
std::string print(const std::string& conversion, T value) {
  // The conversion was put together by formatScalar and fits the value.
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wformat-nonliteral"
  const int length = std::snprintf(nullptr, 0, conversion.c_str(), value);
  if (length <= 0) return {};
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  std::snprintf(text.data(), text.size(), conversion.c_str(), value);
#pragma clang diagnostic pop
  text.pop_back();
  return text;
}

/// Minus and the digits of the magnitude, in the field of `spec`.
std::string signedOctal(std::string_view spec, std::int32_t value) {
  std::string digitsOnly = print("%llo", -static_cast<long long>(value));
  return print(std::string(spec) + "s", ("-" + digitsOnly).c_str());
}

/// The same conversion, its field filled with blanks at the right, as OSL has it for texts.
std::string leftAligned(std::string_view spec) {
  std::string flagged = "%-";
  std::size_t i = 1;
  for (; i < spec.size() && contains(flags, spec[i]); ++i)
    if (spec[i] == '+' || spec[i] == ' ') flagged += spec[i];
  return flagged + std::string(spec.substr(i));
}

}  // namespace

FormatKind kindOf(char conversion) {
  if (conversion == 's') return FormatKind::string;
  return contains(integerConversions, conversion) ? FormatKind::integer : FormatKind::floating;
}

std::optional<std::vector<FormatPiece>> splitFormat(std::string_view format) {
  std::vector<FormatPiece> pieces;
  std::string plain;
  for (std::size_t i = 0; i < format.size();) {
    if (format[i] != '%') {
      plain += format[i++];
      continue;
    }
    if (format.substr(i, 2) == "%%") {
      plain += "%%";
      i += 2;
      continue;
    }
    const std::size_t length = conversionLength(format.substr(i));
    if (length == 0) return std::nullopt;
    if (!plain.empty()) pieces.push_back({std::move(plain), 0});
    plain.clear();
    std::string conversion(format.substr(i, length));
    std::erase_if(conversion, [&](char c) { return contains(lengths, c); });
    pieces.push_back({std::move(conversion), format[i + length - 1]});
    i += length;
  }
  if (!plain.empty()) pieces.push_back({std::move(plain), 0});
  return pieces;
}

std::string formatScalar(std::string_view conversion, const FormatScalar& value) {
  std::string spec = "%";
  std::size_t i = 1;
  while (i < conversion.size() && contains(flags, conversion[i])) {
    if (!contains(spec, conversion[i])) spec += conversion[i];
    ++i;
  }
  if (const int width = numberAt(conversion, i); width > 0) spec += std::to_string(width);
  if (i < conversion.size() && conversion[i] == '.') spec += "." + std::to_string(numberAt(conversion, ++i));
  const char given = conversion.back();
  if (const auto* integer = std::get_if<std::int32_t>(&value)) {
    // Octal digits are signed, others are not.
    if (given == 'o' && *integer < 0) return signedOctal(spec, *integer);
    return print(spec + (contains(integerConversions, given) ? given : 'd'), *integer);
  }
  if (const auto* number = std::get_if<float>(&value)) {
    const std::string shown = contains(floatingConversions, given) ? std::string(1, given) : "f";
    // What is not a number of digits begins at the left of its field, and no zeros are put before it.
    if (!std::isfinite(*number)) spec = leftAligned(spec);
    return print(spec + shown, static_cast<double>(*number));
  }
  const std::string_view text = std::get<std::string_view>(value);
  if (spec == "%") return std::string(text);
  return print(leftAligned(spec) + 's', std::string(text).c_str());
}

std::string formatText(std::string_view format, std::span<const FormatArgument> arguments) {
  std::string text;
  std::size_t next = 0;
  for (std::size_t i = 0; i < format.size();) {
    if (format[i] != '%') {
      text += format[i++];
      continue;
    }
    if (format.substr(i, 2) == "%%") {
      text += '%';
      i += 2;
      continue;
    }
    const std::size_t length = conversionLength(format.substr(i));
    if (length == 0 || next == arguments.size()) {
      text += format.substr(i, std::max<std::size_t>(length, 1));
      i += std::max<std::size_t>(length, 1);
      continue;
    }
    const char* separator = "";
    for (const FormatScalar& scalar : arguments[next]) {
      text += separator + formatScalar(format.substr(i, length), scalar);
      separator = " ";
    }
    ++next;
    i += length;
  }
  return text;
}

}  // namespace aerosol::lang

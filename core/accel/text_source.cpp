#include "core/accel/text_source.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

namespace aerosol::accel {

namespace {

template <class Number>
std::optional<Number> parseWhole(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || end != token.data() + token.size()) return {};
  return value;
}

}  // namespace

Result<TextSource> TextSource::read(const std::string& path) {
  const auto fail = [&](int code) {
    return Diagnostic{
        Severity::error, {path, 0, 0}, std::string("cannot read the file: ") + std::strerror(code), {}, {}};
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) return fail(errno);
  std::string text;
  char block[1 << 16];
  while (const std::size_t count = std::fread(block, 1, sizeof block, file.get())) text.append(block, count);
  if (std::ferror(file.get())) return fail(errno);
  return TextSource(path, std::move(text));
}

Diagnostic TextSource::at(std::size_t offset, std::string message, Severity severity) const {
  const std::string_view before = text().substr(0, offset);
  const std::size_t lineStart = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  std::string_view line = text().substr(lineStart, text().find('\n', lineStart) - lineStart);
  if (line.ends_with('\r')) line.remove_suffix(1);
  constexpr std::size_t longestShown = 200;
  const auto lineNumber = static_cast<int>(std::ranges::count(before, '\n')) + 1;
  const auto column = static_cast<int>(before.size() - lineStart) + 1;
  return {severity, {file_, lineNumber, column}, std::move(message), std::string(line.substr(0, longestShown)), {}};
}

Diagnostic TextSource::atByte(std::size_t offset, const std::string& message) const {
  return {Severity::error, {file_, 0, 0}, "at byte " + std::to_string(offset) + ": " + message, {}, {}};
}

std::optional<double> parseNumber(std::string_view token) {
  const auto value = parseWhole<double>(token);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long long> parseInteger(std::string_view token) { return parseWhole<long long>(token); }

}  // namespace aerosol::accel

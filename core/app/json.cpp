#include "core/app/json.h"

#include <fmt/format.h>

#include <cmath>

namespace aerosol::app {

namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

}  // namespace

void JsonWriter::breakLine() { text_ += '\n' + std::string(static_cast<std::size_t>(2 * depth_), ' '); }

void JsonWriter::beginValue() {
  if (!afterKey_ && depth_ > 0) {
    if (!isFirst_) text_ += ',';
    breakLine();
  }
  afterKey_ = false;
  isFirst_ = false;
}

JsonWriter& JsonWriter::open(char bracket) {
  beginValue();
  text_ += bracket;
  ++depth_;
  isFirst_ = true;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  --depth_;
  if (!isFirst_) breakLine();
  text_ += bracket;
  isFirst_ = false;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  beginValue();
  text_ += quoted(name) + ": ";
  afterKey_ = true;
  return *this;
}

JsonWriter& JsonWriter::text(std::string_view value) {
  beginValue();
  text_ += quoted(value);
  return *this;
}

JsonWriter& JsonWriter::number(double value) {
  beginValue();
  text_ += std::isfinite(value) ? fmt::format("{}", value) : "null";
  return *this;
}

JsonWriter& JsonWriter::count(std::uint64_t value) {
  beginValue();
  text_ += std::to_string(value);
  return *this;
}

JsonWriter& JsonWriter::boolean(bool value) {
  beginValue();
  text_ += value ? "true" : "false";
  return *this;
}

}  // namespace aerosol::app

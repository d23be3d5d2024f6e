// A text or binary file in memory, and errors that point into it. Internal to this folder.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace aerosol::accel {

class TextSource {
 public:
  /// The whole file; an error when it cannot be read.
  static Result<TextSource> read(const std::string& path);
  /// Text that is already in memory, under the name `file`.
  TextSource(std::string file, std::string text) : file_(std::move(file)), text_(std::move(text)) {}

  std::string_view text() const { return text_; }
  const std::string& file() const { return file_; }

  /// A message about the byte at `offset`, with its line and column.
  Diagnostic at(std::size_t offset, std::string message, Severity severity = Severity::error) const;
  /// A message about the byte at `offset` of binary data: it names the byte, not a line.
  Diagnostic atByte(std::size_t offset, const std::string& message) const;

 private:
  std::string file_, text_;
};

/// A finite number that fills `token` to its end, a leading + included; nothing otherwise.
std::optional<double> parseNumber(std::string_view token);
/// The same for a decimal integer.
std::optional<long long> parseInteger(std::string_view token);

}  // namespace aerosol::accel

// The values of a PLY file, one after the other. Internal to this folder.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/accel/ply_header.h"

namespace aerosol::accel {

/// Reads one value after the other. Every value is exact in a double.
class PlyValueReader {
 public:
  PlyValueReader(const TextSource& source, PlyFormat format, std::size_t offset)
      : source_(source), format_(format), position_(offset) {}

  /// Nothing when the data ends or is not a value of the type; `error()` tells which.
  std::optional<double> read(PlyType type) { return format_ == PlyFormat::ascii ? readText(type) : readBinary(type); }

  std::size_t bytesLeft() const { return source_.text().size() - position_; }
  PlyFormat format() const { return format_; }
  /// A message about the value that was read last, or could not be read.
  Diagnostic error(const std::string& message) const {
    return format_ == PlyFormat::ascii ? source_.at(start_, message) : source_.atByte(start_, message);
  }
  Diagnostic readError() const {
    return error(atEnd_ ? "the file ends too early" : "expected a number of the declared type");
  }

 private:
  std::optional<double> readText(PlyType type) {
    const std::string_view text = source_.text();
    position_ = std::min(text.find_first_not_of(" \t\r\n", position_), text.size());
    start_ = position_;
    atEnd_ = position_ == text.size();
    if (atEnd_) return {};
    position_ = std::min(text.find_first_of(" \t\r\n", position_), text.size());
    const auto value = parseNumber(text.substr(start_, position_ - start_));
    if (!value || (isInteger(type) && *value != std::trunc(*value))) return {};
    return value;
  }

  std::optional<double> readBinary(PlyType type) {
    start_ = position_;
    atEnd_ = bytesLeft() < sizeOf(type);
    if (atEnd_) return {};
    unsigned char bytes[8];
    std::memcpy(bytes, source_.text().data() + position_, sizeOf(type));
    position_ += sizeOf(type);
    const bool isHostOrder = (format_ == PlyFormat::littleEndian) == (std::endian::native == std::endian::little);
    if (!isHostOrder) std::reverse(bytes, bytes + sizeOf(type));
    switch (type) {
      case PlyType::int8:
        return decode<std::int8_t>(bytes);
      case PlyType::uint8:
        return decode<std::uint8_t>(bytes);
      case PlyType::int16:
        return decode<std::int16_t>(bytes);
      case PlyType::uint16:
        return decode<std::uint16_t>(bytes);
      case PlyType::int32:
        return decode<std::int32_t>(bytes);
      case PlyType::uint32:
        return decode<std::uint32_t>(bytes);
      case PlyType::float32:
        return decode<float>(bytes);
      case PlyType::float64:
        return decode<double>(bytes);
    }
    return {};
  }

  template <class T>
  static double decode(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  }

  const TextSource& source_;
  PlyFormat format_;
  std::size_t position_, start_ = 0;
  bool atEnd_ = false;
};

}  // namespace aerosol::accel

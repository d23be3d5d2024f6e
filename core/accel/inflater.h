// Data compressed by zlib, as a stream. Internal to this folder.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>

namespace aerosol::accel {

/// Memory grows with what is really there: the caller asks for pieces.
class Inflater {
 public:
  explicit Inflater(std::string_view compressed) : left_(compressed) { isOpen_ = inflateInit(&stream_) == Z_OK; }
  ~Inflater() {
    if (isOpen_) inflateEnd(&stream_);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Exactly `size` bytes; false when the stream ends before or is damaged.
  bool read(void* target, std::size_t size) {
    if (!isOpen_) return false;
    auto* out = static_cast<Bytef*>(target);
    while (size > 0) {
      if (stream_.avail_in == 0) refill();
      const auto room = static_cast<uInt>(std::min<std::size_t>(size, largestPiece));
      stream_.next_out = out;
      stream_.avail_out = room;
      const int state = inflate(&stream_, Z_NO_FLUSH);
      const std::size_t written = room - stream_.avail_out;
      out += written;
      size -= written;
      if (state == Z_OK || (state == Z_STREAM_END && size == 0)) continue;
      return false;
    }
    return true;
  }

  /// A number in the order of bytes of the machine, which has to be little-endian.
  template <class T>
    requires std::is_arithmetic_v<T>
  bool read(T& value) {
    return read(&value, sizeof value);
  }

  /// After the last number: whether the data are those that were written, by their check sum.
  bool isIntact() {
    Bytef byte = 0;
    if (!isOpen_) return false;
    if (stream_.avail_in == 0) refill();
    stream_.next_out = &byte;
    stream_.avail_out = 1;
    const int state = inflate(&stream_, Z_NO_FLUSH);
    return state == Z_STREAM_END || (state == Z_OK && stream_.avail_out == 0);
  }

 private:
  static constexpr std::size_t largestPiece = std::numeric_limits<uInt>::max();

  void refill() {
    const std::size_t size = std::min(left_.size(), largestPiece);
    // zlib does not write through it.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(left_.data()));
    stream_.avail_in = static_cast<uInt>(size);
    left_.remove_prefix(size);
  }

  std::string_view left_;
  z_stream stream_{};
  bool isOpen_ = false;
};

}  // namespace aerosol::accel

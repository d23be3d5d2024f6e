// Numbers and texts to bytes and back, for what is kept on disk and what is hashed. Little-endian hosts only.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace aerosol::jit {

static_assert(std::endian::native == std::endian::little);

class ByteWriter {
 public:
  template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>)
  ByteWriter& operator<<(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    bytes_.append(bytes, sizeof(T));
    return *this;
  }
  ByteWriter& operator<<(std::string_view text) {
    *this << static_cast<std::uint64_t>(text.size());
    bytes_.append(text);
    return *this;
  }
  ByteWriter& operator<<(const std::string& text) { return *this << std::string_view(text); }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads what a ByteWriter wrote. Once something does not fit, `failed` and everything read is zero or empty.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>)
  ByteReader& operator>>(T& value) {
    value = T{};
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      *this >> byte;
      if (byte > 1) fail();
      value = byte == 1;
    } else if (rest_.size() < sizeof(T)) {
      fail();
    } else {
      std::memcpy(&value, rest_.data(), sizeof(T));
      rest_.remove_prefix(sizeof(T));
    }
    return *this;
  }
  ByteReader& operator>>(std::string& text) {
    std::uint64_t size = 0;
    *this >> size;
    text.clear();
    if (size > rest_.size()) {
      fail();
    } else {
      text.assign(rest_.substr(0, size));
      rest_.remove_prefix(size);
    }
    return *this;
  }
  /// A number of elements that follow, each at least one byte long.
  std::size_t count() {
    std::uint64_t size = 0;
    *this >> size;
    if (size <= rest_.size()) return size;
    fail();
    return 0;
  }

  bool failed() const { return failed_; }
  bool atEnd() const { return !failed_ && rest_.empty(); }
  std::string_view rest() const { return rest_; }

 private:
  void fail() {
    failed_ = true;
    rest_ = {};
  }

  std::string_view rest_;
  bool failed_ = false;
};

}  // namespace aerosol::jit

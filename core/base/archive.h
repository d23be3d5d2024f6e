// Plain values as bytes and back, for caches: one description of a type serves both directions.
//
// A type describes itself by `template <class A> void describe(A& archive, T& value) { archive(value.a, value.b); }`,
// found by argument-dependent lookup. Little-endian hosts only. Reading damaged bytes fails; it never over-reads.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace aerosol {

static_assert(std::endian::native == std::endian::little);

class ArchiveWriter {
 public:
  static constexpr bool isReading = false;

  template <class... T>
  void operator()(T&... values) {
    (write(values), ...);
  }
  std::string take() { return std::move(bytes_); }

 private:
  template <class T>
  void write(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    } else {
      describe(*this, value);
    }
  }
  void write(std::string& text) {
    writeSize(text.size());
    bytes_ += text;
  }
  template <class T>
  void write(std::vector<T>& items) {
    writeSize(items.size());
    for (T& item : items) write(item);
  }
  template <class... T>
  void write(std::variant<T...>& value) {
    auto index = static_cast<std::uint8_t>(value.index());
    write(index);
    std::visit([&](auto& alternative) { write(alternative); }, value);
  }
  void write(std::monostate&) {}
  void writeSize(std::size_t size) {
    auto size32 = static_cast<std::uint32_t>(size);
    write(size32);
  }

  std::string bytes_;
};

class ArchiveReader {
 public:
  static constexpr bool isReading = true;

  explicit ArchiveReader(std::string_view bytes) : rest_(bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  /// Whether everything was there, and nothing more.
  bool succeeded() const { return !failed_ && rest_.empty(); }

 private:
  static constexpr int maximumDepth = 200;

  template <class T>
  void read(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      if (rest_.size() < sizeof(T)) {
        failed_ = true;
        return;
      }
      std::memcpy(&value, rest_.data(), sizeof(T));
      rest_.remove_prefix(sizeof(T));
    } else {
      if (++depth_ > maximumDepth) failed_ = true;
      if (!failed_) describe(*this, value);
      --depth_;
    }
  }
  void read(bool& value) {
    std::uint8_t byte = 0;
    read(byte);
    if (byte > 1) failed_ = true;
    value = byte == 1;
  }
  void read(std::string& text) {
    const std::size_t size = readSize();
    if (failed_) return;
    text.assign(rest_.substr(0, size));
    rest_.remove_prefix(size);
  }
  template <class T>
  void read(std::vector<T>& items) {
    const std::size_t size = readSize();
    items.clear();
    for (std::size_t i = 0; i < size && !failed_; ++i) read(items.emplace_back());
  }
  template <class... T>
  void read(std::variant<T...>& value) {
    std::uint8_t index = 0;
    read(index);
    if (index >= sizeof...(T)) failed_ = true;
    if (!failed_) readAlternative(value, index, std::index_sequence_for<T...>());
  }
  template <class... T, std::size_t... I>
  void readAlternative(std::variant<T...>& value, std::size_t index, std::index_sequence<I...>) {
    ((index == I ? read(value.template emplace<I>()) : void()), ...);
  }
  void read(std::monostate&) {}
  /// Every element takes at least one byte, so a size beyond the rest is damage.
  std::size_t readSize() {
    std::uint32_t size = 0;
    read(size);
    if (size > rest_.size()) failed_ = true;
    return failed_ ? 0 : size;
  }

  std::string_view rest_;
  int depth_ = 0;
  bool failed_ = false;
};

}  // namespace aerosol

// Arrays that are short nearly always: what is not used costs nothing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

namespace aerosol {

/// Up to `Near` elements lie in the object itself, more of them elsewhere; only those that are there are initialised.
template <class T, std::size_t Near>
class SmallArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  SmallArray() {}
  explicit SmallArray(std::size_t size) { resize(size); }
  SmallArray(const SmallArray& other) { *this = other; }
  SmallArray& operator=(const SmallArray& other) {
    if (this == &other) return *this;
    reserve(other.size_, 0);
    std::uninitialized_copy_n(other.data(), other.size_, data());
    size_ = other.size_;
    return *this;
  }

  /// Elements beyond the present ones are value-initialised.
  void resize(std::size_t size) {
    reserve(size, size_);
    if (size > size_) std::uninitialized_value_construct_n(data() + size_, size - size_);
    size_ = size;
  }
  /// Shorter or as long: no element is touched.
  void truncate(std::size_t size) { size_ = size; }

  std::size_t size() const { return size_; }
  T* data() { return far_ ? far_.get() : std::launder(reinterpret_cast<T*>(near_)); }
  const T* data() const { return far_ ? far_.get() : std::launder(reinterpret_cast<const T*>(near_)); }
  T& operator[](std::size_t i) { return data()[i]; }
  const T& operator[](std::size_t i) const { return data()[i]; }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }

 private:
  /// Room for `size` elements; the first `kept` stay.
  void reserve(std::size_t size, std::size_t kept) {
    if (size <= room_) return;
    const std::size_t room = std::max(size, 2 * room_);
    auto more = std::make_unique<T[]>(room);
    std::copy_n(data(), kept, more.get());
    far_ = std::move(more);
    room_ = room;
  }

  std::size_t size_ = 0, room_ = Near;
  std::unique_ptr<T[]> far_;
  alignas(T) std::byte near_[Near * sizeof(T)];
};

}  // namespace aerosol

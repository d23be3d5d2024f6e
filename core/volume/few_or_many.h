// A list that is short nearly always: the first entries need no memory of their own.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace aerosol::volume {

template <class T, std::size_t few>
class FewOrMany {
 public:
  void push_back(const T& value) { emplace_back() = value; }
  /// A new entry, as T() is or as one that was there before.
  T& emplace_back() { return size_ < few ? few_[size_++] : (++size_, many_.emplace_back()); }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return i < few ? few_[i] : many_[i - few]; }
  const T& operator[](std::size_t i) const { return i < few ? few_[i] : many_[i - few]; }

 private:
  std::size_t size_ = 0;
  std::array<T, few> few_;
  std::vector<T> many_;
};

}  // namespace aerosol::volume

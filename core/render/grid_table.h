// Functions of a few numbers, known at the nodes of a grid.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace aerosol::render {

/// Values over a grid in N dimensions, interpolated linearly; coordinates from 0 to 1.
template <std::size_t N, class Value = float>
class GridTable {
 public:
  template <class Function>
  GridTable(std::array<int, N> counts, Function&& value) : counts_(counts) {
    std::size_t size = 1;
    for (const int count : counts) size *= static_cast<std::size_t>(count);
    values_.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      std::array<float, N> at;
      std::size_t rest = i;
      for (std::size_t d = 0; d < N; ++d) {
        const auto count = static_cast<std::size_t>(counts[d]);
        at[d] = static_cast<float>(rest % count) / static_cast<float>(count - 1);
        rest /= count;
      }
      values_[i] = value(at);
    }
  }

  Value operator()(std::array<float, N> at) const {
    std::array<std::size_t, N> lower;
    std::array<float, N> part;
    for (std::size_t d = 0; d < N; ++d) {
      const float x = std::clamp(at[d], 0.0f, 1.0f) * static_cast<float>(counts_[d] - 1);
      const int cell = std::min(static_cast<int>(x), counts_[d] - 2);
      lower[d] = static_cast<std::size_t>(cell);
      part[d] = x - static_cast<float>(cell);
    }
    Value sum{};
    for (unsigned corner = 0; corner < 1u << N; ++corner) {
      float weight = 1;
      std::size_t index = 0, stride = 1;
      for (std::size_t d = 0; d < N; ++d) {
        const bool isUpper = (corner >> d & 1u) != 0;
        weight *= isUpper ? part[d] : 1 - part[d];
        index += (lower[d] + (isUpper ? 1 : 0)) * stride;
        stride *= static_cast<std::size_t>(counts_[d]);
      }
      if (weight > 0) sum = sum + values_[index] * weight;
    }
    return sum;
  }

 private:
  std::array<int, N> counts_;
  std::vector<Value> values_;
};

}  // namespace aerosol::render

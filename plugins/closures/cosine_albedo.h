// The directional albedo of lobes over a hemisphere that have one roughness, integrated once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/render/warp.h"

namespace aerosol::render {

/// By roughness and cosine of the viewer, of π f given as `shape(roughness, viewer, light, between)`.
class CosineAlbedo {
 public:
  template <class Shape>
  explicit CosineAlbedo(Shape&& shape) {
    for (int r = 0; r < count; ++r) {
      for (int c = 0; c < count; ++c) table_[index(r, c)] = integrate(shape, place(r), std::max(place(c), 0.03f));
    }
  }
  float operator()(float roughness, float cosine) const {
    float betweenRows = 0, betweenColumns = 0;
    const int r = cell(roughness, betweenRows), c = cell(std::sqrt(std::max(cosine, 0.0f)), betweenColumns);
    const auto row = [&](int i) {
      return table_[index(i, c)] * (1 - betweenColumns) + table_[index(i, c + 1)] * betweenColumns;
    };
    return row(r) * (1 - betweenRows) + row(r + 1) * betweenRows;
  }
  /// By which the lobe is divided to scatter no more than arrives. The hundredth more is for the table's own error.
  float excess(float roughness, float cosine) const { return std::max(1.0f, 1.01f * (*this)(roughness, cosine)); }

 private:
  static constexpr int count = 48;
  static std::size_t index(int r, int c) { return static_cast<std::size_t>(r * count + c); }
  static float place(int i) { return static_cast<float>(i) / (count - 1); }
  static int cell(float x, float& part) {
    const float scaled = std::clamp(x, 0.0f, 1.0f) * (count - 1);
    const int i = std::min(static_cast<int>(scaled), count - 2);
    part = scaled - static_cast<float>(i);
    return i;
  }

  /// Mean over directions drawn by the cosine; columns are roots of it.
  template <class Shape>
  static float integrate(Shape&& shape, float roughness, float rootOfCosine) {
    constexpr int side = 32;
    const float viewer = rootOfCosine * rootOfCosine, sine = std::sqrt(std::max(0.0f, 1 - viewer * viewer));
    float sum = 0;
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j) {
        const auto d =
            toCosineHemisphere({(static_cast<float>(i) + 0.5f) / side, (static_cast<float>(j) + 0.5f) / side});
        const auto light = static_cast<float>(d[2]);
        sum += shape(roughness, viewer, light, static_cast<float>(d[0]) * sine + light * viewer);
      }
    }
    return sum / (side * side);
  }

  std::array<float, static_cast<std::size_t>(count* count)> table_{};
};

}  // namespace aerosol::render

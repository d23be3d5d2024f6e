// Interpolated values point by point, through NanoVDB's tree: for grids whose extent no directory covers. Internal to
// the module. The arithmetic is that of interpolate_lanes.inc.
#pragma once

#include <nanovdb/NanoVDB.h>

#include <cmath>
#include <cstddef>

#include "core/grid/module/lookup.h"

namespace aerosol::grid {

template <class ValueT>
class ScalarLookup {
 public:
  static constexpr int channels = static_cast<int>(sizeof(ValueT) / sizeof(float));

  explicit ScalarLookup(const nanovdb::NanoGrid<ValueT>& grid) : accessor_(grid.getAccessor()) {}

  void lookUp(VoxelInterpolation interpolation, const LookupPoints& a) {
    for (std::size_t i = 0; i < a.count; ++i) {
      locate(a, i, interpolation == VoxelInterpolation::nearest ? 0.5 : 0.0);
      float result[channels];
      if (interpolation == VoxelInterpolation::nearest) {
        read(0, 0, 0, result);
      } else if (interpolation == VoxelInterpolation::trilinear) {
        trilinear(result);
      } else {
        tricubic(result);
      }
      for (int c = 0; c < channels; ++c) a.results[static_cast<std::size_t>(c) * a.count + i] = result[c];
    }
  }

 private:
  void locate(const LookupPoints& a, std::size_t i, double offset) {
    constexpr double far = 1073741824.0;
    const double p[3] = {static_cast<double>(a.x[i]), static_cast<double>(a.y[i]), static_cast<double>(a.z[i])};
    for (int r = 0; r < 3; ++r) {
      const double* m = a.fileToIndex + 4 * r;
      double q = m[0] * p[0] + m[1] * p[1] + m[2] * p[2];
      if (a.divisors == nullptr) {
        q += m[3] + offset;
      } else {
        const double* w = a.divisors + 4 * r;
        const double divisor = w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3];
        q = divisor > 0 ? (q + m[3]) / divisor + offset : far;
      }
      q = q < far ? q : far;
      q = q > -far ? q : -far;
      const double below = std::floor(q);
      voxel_[r] = static_cast<std::int32_t>(below);
      t_[r] = static_cast<float>(q - below);
    }
  }

  void read(int x, int y, int z, float* value) {
    const ValueT v = accessor_.getValue(nanovdb::Coord(voxel_[0] + x, voxel_[1] + y, voxel_[2] + z));
    __builtin_memcpy(value, &v, sizeof v);
  }

  void trilinear(float* result) {
    float corner[8][channels];
    for (int k = 0; k < 8; ++k) read(k >> 2, k >> 1 & 1, k & 1, corner[k]);
    for (int c = 0; c < channels; ++c) {
      const auto mix = [](float& a, float b, float w) { a = a + (b - a) * w; };
      for (int k = 0; k < 8; k += 2) mix(corner[k][c], corner[k + 1][c], t_[2]);
      for (int k = 0; k < 8; k += 4) mix(corner[k][c], corner[k + 2][c], t_[1]);
      mix(corner[0][c], corner[4][c], t_[0]);
      result[c] = corner[0][c];
    }
  }

  void tricubic(float* result) {
    float weight[3][4];
    for (int r = 0; r < 3; ++r) {
      const float x = t_[r], y = 1 - x;
      weight[r][0] = y * y * y * (1.0f / 6.0f);
      weight[r][1] = (2.0f / 3.0f) - 0.5f * x * x * (2 - x);
      weight[r][2] = (2.0f / 3.0f) - 0.5f * y * y * (2 - y);
      weight[r][3] = x * x * x * (1.0f / 6.0f);
    }
    for (int c = 0; c < channels; ++c) result[c] = 0;
    for (int k = 0; k < 64; ++k) {
      const int x = k >> 4, y = k >> 2 & 3, z = k & 3;
      float value[channels];
      read(x - 1, y - 1, z - 1, value);
      const float w = weight[0][x] * weight[1][y] * weight[2][z];
      for (int c = 0; c < channels; ++c) result[c] += value[c] * w;
    }
  }

  typename nanovdb::NanoGrid<ValueT>::AccessorType accessor_;
  std::int32_t voxel_[3] = {};
  float t_[3] = {};
};

}  // namespace aerosol::grid

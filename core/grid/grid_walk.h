// Where voxel grids are along a line: what the structures that know have in common.
#pragma once

#include <array>

#include "core/base/voxel_map.h"

namespace aerosol::grid {

/// A line in front of the planes of a grid: index_r = (a_r + b_r t) / (c_r + d_r t).
struct LineToGrid {
  std::array<double, 3> a, b, c, d;

  LineToGrid(const VoxelMap& map, const std::array<double, 3>& origin, const std::array<double, 3>& direction) {
    const auto place = [&](const VoxelMap::Form& f) {
      return f[0] * origin[0] + f[1] * origin[1] + f[2] * origin[2] + f[3];
    };
    const auto way = [&](const VoxelMap::Form& f) {
      return f[0] * direction[0] + f[1] * direction[1] + f[2] * direction[2];
    };
    for (std::size_t r = 0; r < 3; ++r) {
      a[r] = place(map.numerator[r]);
      b[r] = way(map.numerator[r]);
      c[r] = place(map.denominator[r]);
      d[r] = way(map.denominator[r]);
    }
  }
};

}  // namespace aerosol::grid

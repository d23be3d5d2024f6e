// Where a velocity grid carries matter while the shutter is open.
#pragma once

#include <algorithm>
#include <array>

#include "core/base/voxel_grid.h"

namespace aerosol::render {

/// What is at x when the velocities' reference time is, stands at x + s v(x) with s between the two of `seconds`.
struct CarriedMatter {
  const VoxelGrid* velocity = nullptr;     ///< Null: nothing is carried.
  std::array<double, 2> seconds = {0, 0};  ///< Times the factor of the velocities.

  /// Where the matter of a box of the file's space may be: by the velocities in that box, and no further.
  void carry(std::array<double, 3>& lower, std::array<double, 3>& upper) const {
    if (!velocity) return;
    const std::array<double, 3> from = lower, to = upper;
    for (std::size_t c = 0; c < 3; ++c) {
      const VoxelRange v = velocity->range(VoxelInterpolation::trilinear, from, to, static_cast<int>(c));
      const double a = static_cast<double>(v.least), b = static_cast<double>(v.greatest);
      const auto [least, greatest] = std::minmax({seconds[0] * a, seconds[0] * b, seconds[1] * a, seconds[1] * b, 0.0});
      lower[c] += least;
      upper[c] += greatest;
    }
  }
};

}  // namespace aerosol::render

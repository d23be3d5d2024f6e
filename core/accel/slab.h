// A line against a slab, and boxes under affine maps.
#pragma once

#include <cmath>

#include "core/accel/double3.h"
#include "core/accel/volume_shape.h"

namespace aerosol::accel {

/// Narrows `interval` to where a line with coordinate `origin` + t `direction` is within [-1, 1); false when nowhere.
/// Division by ±0 is never done, so the sign of a zero component does not matter.
inline bool clipToSlab(double origin, double direction, Interval& interval) {
  if (direction == 0) return origin >= -1 && origin < 1;
  const double a = (-1 - origin) / direction;
  const double b = (1 - origin) / direction;
  interval.t0 = std::fmax(interval.t0, std::fmin(a, b));
  interval.t1 = std::fmin(interval.t1, std::fmax(a, b));
  return interval.t0 < interval.t1;
}

/// The smallest float box around the image of [-1, 1]^3.
inline Box<World> unitCubeBounds(const Matrix4& m) {
  const auto extent = [&](std::size_t i) { return std::fabs(m[i][0]) + std::fabs(m[i][1]) + std::fabs(m[i][2]); };
  return outwardBox({m[0][3], m[1][3], m[2][3]}, {extent(0), extent(1), extent(2)});
}

}  // namespace aerosol::accel

// The unit sphere in double precision. Internal to this folder.
#pragma once

#include <optional>

#include "core/accel/convex_volume.h"
#include "core/accel/double3.h"

namespace aerosol::accel {

/// Where the line o + t d is inside the unit sphere; nothing for a tangent or a zero direction.
///
/// The textbook discriminant b² - ac loses everything once |o| is large: both terms are |o|² big and their difference
/// is of order one. After Haines, Günther and Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection" (Ray
/// Tracing Gems, 2019): go to the point of closest approach first, p = o + t_c d with t_c = -o·d / d·d. There the
/// half chord is sqrt((1 - p·p) / d·d), with an error of |o| ulps and not of |o|².
inline std::optional<Interval> intersectUnitSphere(Double3 o, Double3 d) {
  const double dd = dot(d, d);
  if (!(dd > 0)) return {};
  const double closest = -dot(o, d) / dd;
  const Double3 p = o + d * closest;
  const double inside = 1 - dot(p, p);
  if (!(inside > 0)) return {};
  const double half = std::sqrt(inside / dd);
  return Interval{closest - half, closest + half};
}

/// The tight box of the unit sphere's image: along world axis i it reaches |row i of the linear part|.
inline Box<World> unitSphereBounds(const Matrix4& m) {
  const auto extent = [&](std::size_t i) { return length({m[i][0], m[i][1], m[i][2]}); };
  return outwardBox({m[0][3], m[1][3], m[2][3]}, {extent(0), extent(1), extent(2)});
}

}  // namespace aerosol::accel

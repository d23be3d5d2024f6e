#include "core/volume/phase.h"

#include <algorithm>

namespace aerosol::volume {

Deflection Deflection::between(Vector<World> before, Vector<World> after) {
  // |a ± b|² = 2 ± 2 cos for unit vectors; an error in their lengths enters in second order only.
  const auto squared = [](double x, double y, double z) { return x * x + y * y + z * z; };
  const double ax = before.x, ay = before.y, az = before.z, bx = after.x, by = after.y, bz = after.z;
  const double minus = 0.5 * squared(ax - bx, ay - by, az - bz), plus = 0.5 * squared(ax + bx, ay + by, az + bz);
  if (minus < plus) return {minus, std::max(0.0, 2 - minus)};
  return {std::max(0.0, 2 - plus), plus};
}

}  // namespace aerosol::volume

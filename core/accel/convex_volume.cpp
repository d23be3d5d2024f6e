#include "core/accel/convex_volume.h"

#include "core/accel/double3.h"
#include "core/accel/unit_sphere.h"

namespace aerosol::accel {

namespace {

/// Narrows `interval` to where a line with coordinate `origin` + t `direction` is within [-1, 1); false when nowhere.
/// Division by ±0 is never done, so the sign of a zero component does not matter.
bool clipToSlab(double origin, double direction, Interval& interval) {
  if (direction == 0) return origin >= -1 && origin < 1;
  const double a = (-1 - origin) / direction;
  const double b = (1 - origin) / direction;
  interval.t0 = std::fmax(interval.t0, std::fmin(a, b));
  interval.t1 = std::fmin(interval.t1, std::fmax(a, b));
  return interval.t0 < interval.t1;
}

}  // namespace

Box<World> BoxVolume::worldBounds() const {
  const Matrix4& m = toWorld_.matrix();
  const auto extent = [&](std::size_t i) { return std::fabs(m[i][0]) + std::fabs(m[i][1]) + std::fabs(m[i][2]); };
  return outwardBox({m[0][3], m[1][3], m[2][3]}, {extent(0), extent(1), extent(2)});
}

std::optional<Interval> BoxVolume::intersect(const Ray<World>& ray) const {
  const Double3 o = mapPoint(toWorld_.inverseMatrix(), toDouble(ray.origin));
  const Double3 d = mapVector(toWorld_.inverseMatrix(), toDouble(ray.direction));
  Interval interval{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  if (!clipToSlab(o.x, d.x, interval) || !clipToSlab(o.y, d.y, interval) || !clipToSlab(o.z, d.z, interval)) return {};
  return interval;
}

Box<World> SphereVolume::worldBounds() const { return unitSphereBounds(toWorld_.matrix()); }

std::optional<Interval> SphereVolume::intersect(const Ray<World>& ray) const {
  return intersectUnitSphere(mapPoint(toWorld_.inverseMatrix(), toDouble(ray.origin)),
                             mapVector(toWorld_.inverseMatrix(), toDouble(ray.direction)));
}

}  // namespace aerosol::accel

#include "core/accel/convex_volume.h"

#include "core/accel/slab.h"
#include "core/accel/unit_sphere.h"

namespace aerosol::accel {

Box<World> BoxVolume::worldBounds() const { return unitCubeBounds(toWorld_.matrix()); }

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

// A cylindrical volume primitive with flat ends.

#include "core/accel/slab.h"
#include "plugins/volumes/segment_placement.h"

namespace aerosol::render {

namespace {

/// x² + y² < 1, -1 <= z < 1 under an affine map. A line along the mantle is outside.
class CylinderVolume final : public accel::ConvexVolume {
 public:
  explicit CylinderVolume(const Transform<World, Object>& toWorld) : toWorld_(toWorld) {}

  Box<World> worldBounds() const override {
    const Matrix4& m = toWorld_.matrix();
    const auto extent = [&](std::size_t i) { return std::hypot(m[i][0], m[i][1]) + std::fabs(m[i][2]); };
    return accel::outwardBox({m[0][3], m[1][3], m[2][3]}, {extent(0), extent(1), extent(2)});
  }

  /// From the point nearest to the axis, so that a camera a million radii away loses no digits (see the sphere).
  std::optional<accel::Interval> intersect(const Ray<World>& ray) const override {
    const accel::Double3 o = accel::mapPoint(toWorld_.inverseMatrix(), accel::toDouble(ray.origin));
    const accel::Double3 d = accel::mapVector(toWorld_.inverseMatrix(), accel::toDouble(ray.direction));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    accel::Interval interval{-infinity, infinity};
    const double dd = d.x * d.x + d.y * d.y;
    const double closest = dd > 0 ? -(o.x * d.x + o.y * d.y) / dd : 0;
    const double x = o.x + closest * d.x, y = o.y + closest * d.y;
    const double inside = 1 - (x * x + y * y);
    if (!(inside > 0)) return {};
    if (dd > 0) {
      const double half = std::sqrt(inside / dd);
      interval = {closest - half, closest + half};
    }
    if (!accel::clipToSlab(o.z, d.z, interval)) return {};
    return interval;
  }

 private:
  Transform<World, Object> toWorld_;
};

}  // namespace

void registerVolume_cylinder(Registry& registry) {
  registry.add(VolumeType{
      .described = {.type = "cylinder",
                    .doc =
                        "a cylinder with flat ends, filled with a medium; in its shader's object space the axis runs "
                        "along z from -1 to 1 and the radius is 1",
                    .parameters = segmentParameters("centre of one end, in the primitive's own space",
                                                    "centre of the other end", "radius")},
      .place = placeOnSegment,
      .make = [](const VolumeArguments& arguments) -> Result<std::unique_ptr<const accel::VolumeShape>> {
        if (auto defect = findSegmentDefect(arguments.volume)) return std::move(*defect);
        return {std::make_unique<CylinderVolume>(arguments.toWorld)};
      }});
}

}  // namespace aerosol::render

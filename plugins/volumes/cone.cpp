// A conical volume primitive with a flat base.

#include "core/accel/slab.h"
#include "plugins/volumes/segment_placement.h"

namespace aerosol::render {

namespace {

/// The cone with its apex at z = 1 and a base of radius 1 at z = -1: x² + y² < w² with w = (1 - z) / 2 in (0, 1].
class ConeVolume final : public accel::ConvexVolume {
 public:
  explicit ConeVolume(const Transform<World, Object>& toWorld) : toWorld_(toWorld) {}

  Box<World> worldBounds() const override {
    const Matrix4& m = toWorld_.matrix();
    double lower[3], upper[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const double radius = std::hypot(m[i][0], m[i][1]), base = m[i][3] - m[i][2], apex = m[i][3] + m[i][2];
      lower[i] = std::fmin(base - radius, apex);
      upper[i] = std::fmax(base + radius, apex);
    }
    return {{accel::floatBelow(lower[0]), accel::floatBelow(lower[1]), accel::floatBelow(lower[2])},
            {accel::floatAbove(upper[0]), accel::floatAbove(upper[1]), accel::floatAbove(upper[2])}};
  }

  /// f(t) = x² + y² - w² is negative in both nappes; the slab keeps the one with w > 0. Solved around the point nearest
  /// to the axis, where all terms are of order one.
  std::optional<accel::Interval> intersect(const Ray<World>& ray) const override {
    accel::Double3 o = accel::mapPoint(toWorld_.inverseMatrix(), accel::toDouble(ray.origin));
    const accel::Double3 d = accel::mapVector(toWorld_.inverseMatrix(), accel::toDouble(ray.direction));
    const double dd = d.x * d.x + d.y * d.y;
    const double shift = dd > 0 ? -(o.x * d.x + o.y * d.y) / dd : d.z != 0 ? -o.z / d.z : 0;
    o = o + d * shift;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    accel::Interval interval{-infinity, infinity};
    if (!accel::clipToSlab(o.z, d.z, interval)) return {};
    const double w = 0.5 * (1 - o.z), slope = -0.5 * d.z;
    const double a = dd - slope * slope, b = o.x * d.x + o.y * d.y - w * slope, c = o.x * o.x + o.y * o.y - w * w;
    if (!clipToNappe(a, b, c, slope, interval)) return {};
    return accel::Interval{interval.t0 + shift, interval.t1 + shift};
  }

 private:
  /// Narrows the interval, within which w > 0 but for one end, to a t² + 2 b t + c < 0.
  static bool clipToNappe(double a, double b, double c, double slope, accel::Interval& interval) {
    const double discriminant = b * b - a * c;
    if (a > 0 && !(discriminant > 0)) return false;
    const double q = -(b + std::copysign(std::sqrt(std::fmax(discriminant, 0.0)), b));
    if (a == 0) {
      if (b == 0) return c < 0;
      const double t = -c / (2 * b);
      b > 0 ? interval.t1 = std::fmin(interval.t1, t) : interval.t0 = std::fmax(interval.t0, t);
      return interval.t0 < interval.t1;
    }
    const double r0 = q / a, r1 = q != 0 ? c / q : 0;
    const double first = std::fmin(r0, r1), second = std::fmax(r0, r1);
    if (a > 0) {
      interval.t0 = std::fmax(interval.t0, first);
      interval.t1 = std::fmin(interval.t1, second);
    } else if (slope > 0) {
      interval.t0 = std::fmax(interval.t0, second);
    } else {
      interval.t1 = std::fmin(interval.t1, first);
    }
    return interval.t0 < interval.t1;
  }

  Transform<World, Object> toWorld_;
};

}  // namespace

void registerVolume_cone(Registry& registry) {
  registry.add(VolumeType{
      .described = {.type = "cone",
                    .doc =
                        "a cone filled with a medium; in its shader's object space the apex is at z = 1 and the base "
                        "of radius 1 at z = -1",
                    .parameters = segmentParameters("centre of the base, in the primitive's own space", "apex",
                                                    "radius of the base")},
      .place = placeOnSegment,
      .make = [](const VolumeArguments& arguments) -> Result<std::unique_ptr<const accel::VolumeShape>> {
        if (auto defect = findSegmentDefect(arguments.volume)) return std::move(*defect);
        return {std::make_unique<ConeVolume>(arguments.toWorld)};
      }});
}

}  // namespace aerosol::render

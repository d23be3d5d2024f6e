// Volume primitives whose intersection with a line is one interval, and the two most common of them.
#pragma once

#include <optional>

#include "core/base/geometry.h"

namespace aerosol::accel {

/// An interval of ray distances; t0 <= t1. Double, because a float cannot tell apart the two sides of a small volume
/// that is a million of its sizes away.
struct Interval {
  double t0 = 0, t1 = 0;
};

/// A volume that meets any line in one interval. Implementations are immutable, deterministic, safe to call from any
/// thread, and throw nothing.
class ConvexVolume {
 public:
  virtual ~ConvexVolume() = default;

  /// A box that holds the volume. Infinite where the volume is: such a volume is tested against every ray.
  virtual Box<World> worldBounds() const = 0;

  /// Where the infinite line `ray.origin + t * ray.direction` is inside; `ray.tMin` and `ray.tMax` are not looked at.
  /// Nothing when the line misses or touches in one point. The origin may be inside or behind: then t0 < 0. Ends may be
  /// infinite.
  virtual std::optional<Interval> intersect(const Ray<World>& ray) const = 0;
};

/// The box [-1, 1]^3 under an affine map. Each pair of faces is half-open: a line that runs exactly along a lower face
/// is inside and along an upper face outside, so boxes that share a face never count twice.
class BoxVolume final : public ConvexVolume {
 public:
  explicit BoxVolume(const Transform<World, Object>& toWorld) : toWorld_(toWorld) {}
  Box<World> worldBounds() const override;
  std::optional<Interval> intersect(const Ray<World>& ray) const override;

 private:
  Transform<World, Object> toWorld_;
};

/// The ball of radius 1 under an affine map. A tangent line misses.
class SphereVolume final : public ConvexVolume {
 public:
  explicit SphereVolume(const Transform<World, Object>& toWorld) : toWorld_(toWorld) {}
  Box<World> worldBounds() const override;
  std::optional<Interval> intersect(const Ray<World>& ray) const override;

 private:
  Transform<World, Object> toWorld_;
};

}  // namespace aerosol::accel

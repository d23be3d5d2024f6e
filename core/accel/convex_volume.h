// The two most common volume primitives.
#pragma once

#include "core/accel/volume_shape.h"

namespace aerosol::accel {

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

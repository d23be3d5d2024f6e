// Surfaces and volumes that move. Internal to this folder.
#pragma once

#include <memory>
#include <vector>

#include "core/accel/double3.h"
#include "core/accel/surfaces.h"
#include "core/accel/volume_shape.h"
#include "core/base/motion.h"

namespace aerosol::accel {

using MovingPlacement = MovingTransform<World, Object>;

/// World boxes at `segments` + 1 evenly spaced times from the shutter's opening to its closing. Between two of them
/// their linear interpolation holds the placed box at every time.
std::vector<Box<World>> sweepBounds(const MovingPlacement& placement, const Box<World>& atRest, const Shutter& shutter,
                                    std::size_t segments);

/// How many segments suit a motion; at most what Embree takes.
std::size_t sweepSegments(const MovingPlacement& placement);

/// A ray in the space of what moves: the same distances mean the same points.
inline DoubleRay takeBack(const Transform<World, Object>& placement, const DoubleRay& ray) {
  return {mapPoint(placement.inverseMatrix(), ray.origin), mapVector(placement.inverseMatrix(), ray.direction)};
}

/// A hit in the space of what moves, as the world sees it. `mesh` is the one that was hit, if it was one: it has the
/// point before that was rounded.
SurfaceHit placeHit(const SurfaceHit& hit, const MeshSurface* mesh, const Transform<World, Object>& placement);

/// The ray's distance at which it is nearest to the middle of a box.
double nearestDistance(const DoubleRay& ray, const Box<World>& box);

/// A volume primitive that stands still in a space that moves.
class MovingVolume final : public VolumeShape {
 public:
  MovingVolume(std::unique_ptr<const VolumeShape> atRest, MovingPlacement placement, const Shutter& shutter,
               std::size_t segments);

  /// While the shutter is open.
  Box<World> worldBounds() const override { return bounds_; }
  Box<Object> objectBounds() const override { return atRest_->objectBounds(); }
  /// At the ray's time.
  bool intersect(const Ray<World>& ray, IntervalSink& intervals) const override;

  /// As `sweepBounds` gives them; empty when the volume has no bounds.
  const std::vector<Box<World>>& steps() const { return steps_; }

 private:
  std::unique_ptr<const VolumeShape> atRest_;
  MovingPlacement placement_;
  Box<World> restBounds_, bounds_;
  std::vector<Box<World>> steps_;
};

}  // namespace aerosol::accel

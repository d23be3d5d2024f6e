// Volume primitives whose matter velocities carry beyond them while the shutter is open.
#pragma once

#include <memory>

#include "core/accel/convex_volume.h"
#include "core/base/motion.h"

namespace aerosol::render {

/// A box around all places that the matter of a primitive may be carried to. What is there is asked of the velocities:
/// what was outside of the primitive at their reference time is nothing.
class CarriedVolume final : public accel::VolumeShape {
 public:
  /// `reach`: the box, in the space of `toWorld`, which is the primitive's.
  CarriedVolume(std::unique_ptr<const accel::VolumeShape> atReference, const Transform<World, Object>& toWorld,
                const Box<Object>& reach);

  Box<World> worldBounds() const override { return box_.worldBounds(); }
  Box<Object> objectBounds() const override { return reach_; }
  bool intersect(const Ray<World>& ray, accel::IntervalSink& intervals) const override {
    return static_cast<const accel::VolumeShape&>(box_).intersect(ray, intervals);
  }

  /// A box around the primitive itself.
  Box<Object> boundsAtReference() const { return atReference_->objectBounds(); }
  /// Whether a place was inside of the primitive.
  bool held(Point<Object> point) const;

 private:
  std::unique_ptr<const accel::VolumeShape> atReference_;
  Transform<World, Object> toWorld_;
  Box<Object> reach_;
  accel::BoxVolume box_;
};

}  // namespace aerosol::render

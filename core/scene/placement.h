// Where an object is: one transform, or one that changes with time.
#pragma once

#include <optional>
#include <vector>

#include "core/base/motion.h"

namespace aerosol::scene {

/// A transform as an object has it; the first one of an animation.
template <class To, class From>
struct Placement : Transform<To, From> {
  using Transform<To, From>::Transform;
  Placement() = default;
  Placement(const Transform<To, From>& transform) : Transform<To, From>(transform) {}

  std::vector<MotionKey> keys;  ///< Of an animation, without a problem; empty: it stands still.

  /// The placement while a shutter is open, where something changes in that time.
  std::shared_ptr<const Motion> motionDuring(const Shutter& shutter) const {
    if (keys.empty() || shutter.isInstant()) return nullptr;
    auto motion = std::make_shared<const Motion>(keys);
    return motion->moves(shutter) ? motion : nullptr;
  }
  /// The transform at a time, in seconds.
  Transform<To, From> at(float time) const {
    if (keys.empty()) return *this;
    Matrix4 matrix, inverse;
    Motion(keys).at(static_cast<double>(time), matrix, inverse);
    return {matrix, inverse};
  }
};

}  // namespace aerosol::scene

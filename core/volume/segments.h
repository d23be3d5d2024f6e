// Where a ray is inside of media: of one, and of a constant set of them.
#pragma once

#include <span>

#include "core/volume/medium.h"

namespace aerosol::volume {

/// Where a ray is inside one medium: t0 <= t1, distances along the ray. Double, because a float cannot tell apart the
/// two sides of a small volume that is a million of its sizes away.
struct MediumSpan {
  double t0 = 0;
  double t1 = 0;
  const Medium* medium = nullptr;
};

/// A part of a ray in which the set of media does not change.
struct Segment {
  double t0 = 0;
  double t1 = 0;
  std::span<const Medium* const> media;
};

}  // namespace aerosol::volume

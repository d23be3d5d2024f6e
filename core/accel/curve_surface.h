// Fibres as the queries see them. Internal to this folder.
#pragma once

#include "core/accel/curves.h"
#include "core/accel/surfaces.h"

namespace aerosol::accel {

struct CurveSurface {
  ObjectId object = 0;
  bool passThrough = false;
  CurveSet curves;

  Box<World> worldBounds() const;
};

/// Whether a hit that Embree tells of is the surface that the ray begins on: its distances on fibres have errors.
bool isOwnStart(const CurveSurface& surface, std::uint32_t segment, const DoubleRay& ray, double t);

/// Everything about the hit at distance t, which is from outside. u runs around the fibre, v along it.
SurfaceHit describeHit(const CurveSurface& surface, std::uint32_t segment, const DoubleRay& ray, double t);

}  // namespace aerosol::accel

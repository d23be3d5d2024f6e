// The part of a ray that a light with a cone shines on.
#pragma once

#include <array>

#include "core/base/geometry.h"
#include "core/volume/equiangular.h"

namespace aerosol::render {

/// Directions around an axis.
struct LightCone {
  std::array<double, 3> axis{0, 0, 1};  ///< Unit, in world space.
  double tangent = -1;                  ///< Of the angle between axis and edge; negative: all directions.

  bool isWhole() const { return tangent < 0; }
};

/// Around +z of a light placed by `toWorld`, `tangent` positive; all directions where that changes angles, as circles
/// are no circles then.
LightCone coneAlongZ(const Matrix4& toWorld, double tangent);

/// From where to where a line is inside of a cone, by distances along it: [begin, end], either may be infinite; empty
/// where begin >= end.
struct ConeStretch {
  double begin = 0, end = 0;
};

/// `toApex` leads from the line's origin to the cone's tip, `along` is the line's unit direction.
ConeStretch insideCone(const LightCone& cone, const std::array<double, 3>& toApex, const std::array<double, 3>& along);

}  // namespace aerosol::render

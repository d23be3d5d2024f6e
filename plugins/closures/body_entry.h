// What closures have in common whose light enters a body.
#pragma once

#include <algorithm>

#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

inline Color unitColor(Color c) {
  return {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
}

/// A way into the body. A direction that a turned shading normal leads out of it is mirrored by the surface: no light
/// is lost.
inline ClosureSample entering(const ClosurePoint& point, Vector<World> direction, float weight) {
  const Vector<World> n = point.geometricNormal.vector();
  if (isOnItsSide(point, direction, true)) direction = direction - n * (2 * dot(n, direction));
  return {.direction = direction, .weight = Color(weight), .pdf = 1, .isDelta = true, .entersBody = true};
}

}  // namespace aerosol::render

#include "core/render/subsurface_body.h"

#include <algorithm>
#include <cmath>

namespace aerosol::render {

namespace {

double collisionAlbedo(double reflected, double g) {
  const double e = std::clamp(reflected, 0.0, 1.0);
  const double s = 4.09712 + 4.20863 * e - std::sqrt(9.59217 + 41.6808 * e + 17.7126 * e * e);
  const double s2 = std::clamp(s * s, 0.0, 1.0);
  return std::clamp((1 - s2) / (1 - g * s2), 0.0, 1.0);
}

}  // namespace

SubsurfaceBody bodyThatReflects(Color albedo, Color radius, float anisotropy) {
  SubsurfaceBody body;
  body.anisotropy = std::clamp(anisotropy, -0.98f, 0.98f);
  // Free paths of nothing at all beside long ones are indistinguishable from very short ones, and walks have to end.
  const float least = std::max(1e-3f * maximum(radius), 1e-6f);
  for (int c = 0; c < 3; ++c) {
    body.albedo[c] =
        static_cast<float>(collisionAlbedo(static_cast<double>(albedo[c]), static_cast<double>(body.anisotropy)));
    // The formula reaches 1 but for rounding.
    if (albedo[c] >= 1) body.albedo[c] = 1;
    body.extinction[c] = 1 / std::max(radius[c], least);
  }
  return body;
}

}  // namespace aerosol::render

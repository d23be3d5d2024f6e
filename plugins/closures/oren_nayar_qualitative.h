// The qualitative model of Oren and Nayar 1994, "Generalization of Lambert's Reflectance Model".
#pragma once

#include <algorithm>

namespace aerosol::render {

/// π f for a surface whose facets have slopes of standard deviation sigma, in radians. Cosines to the normal of viewer
/// and light and between the two. Their sine and tangent are written with cosines alone, which is the same.
///
/// Seen at grazing angles the model reflects a + b / 2, up to 1.5% more than arrives: it is scaled down by that.
inline float orenNayar(float sigma, float viewer, float light, float between) {
  const float square = sigma * sigma;
  const float a = 1 - 0.5f * square / (square + 0.33f), b = 0.45f * square / (square + 0.09f);
  const float s = between - viewer * light;
  return (a + (s > 0 ? b * s / std::max(viewer, light) : 0)) / std::max(1.0f, a + 0.5f * b);
}

}  // namespace aerosol::render

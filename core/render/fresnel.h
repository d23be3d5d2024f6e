// How much of the light a smooth boundary reflects.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/color.h"

namespace aerosol::render {

/// Reflectance for unpolarised light at a boundary of dielectrics, in [0, 1]. `cosine` >= 0 is that of the direction on
/// the near side to the normal, `eta` > 0 the index of the far side over that of the near side. Fresnel 1823, in the
/// form without trigonometric functions. The square of the far side's cosine is (η² - 1 + cos²) / η²: written so, it
/// keeps its digits at grazing incidence between equal indices, where 1 - sin² has none.
inline float fresnelDielectric(float cosine, float eta) {
  const float c = std::clamp(cosine, 0.0f, 1.0f);
  const float cosineSquared = ((eta - 1) * (eta + 1) + c * c) / (eta * eta);
  if (cosineSquared <= 0) return eta < 1 ? 1.0f : 0.0f;
  const float t = std::sqrt(cosineSquared);
  const float parallel = (eta * c - t) / (eta * c + t);
  const float perpendicular = (c - eta * t) / (c + eta * t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// The same for a conductor with complex index eta + i k, relative to the near side.
inline float fresnelConductor(float cosine, float eta, float k) {
  const float c = std::clamp(cosine, 0.0f, 1.0f), c2 = c * c, s2 = 1 - c2;
  const float inner = eta * eta - k * k - s2;
  const float a2b2 = std::sqrt(std::max(inner * inner + 4 * eta * eta * k * k, 0.0f));
  const float a = std::sqrt(std::max(0.5f * (a2b2 + inner), 0.0f));
  const float perpendicular = (a2b2 + c2 - 2 * a * c) / (a2b2 + c2 + 2 * a * c);
  const float parallel =
      perpendicular * (c2 * a2b2 + s2 * s2 - 2 * a * c * s2) / (c2 * a2b2 + s2 * s2 + 2 * a * c * s2);
  return std::clamp(0.5f * (parallel + perpendicular), 0.0f, 1.0f);
}

/// f0 + (f90 - f0) (1 - cos)^exponent (Schlick 1994; exponent 5 there).
inline Color fresnelSchlick(float cosine, Color f0, Color f90, float exponent) {
  const float falloff = std::pow(std::clamp(1 - cosine, 0.0f, 1.0f), exponent);
  return f0 + (f90 - f0) * falloff;
}

}  // namespace aerosol::render

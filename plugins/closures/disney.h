// Parts of Disney's material as Mitsuba renders it: Burley 2012, "Physically Based Shading at Disney", and Burley 2015,
// "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/color.h"

namespace aerosol::render::disney {

inline float fifthPower(float x) {
  const float m = std::clamp(x, 0.0f, 1.0f), square = m * m;
  return square * square * m;
}
inline float grazing(float cosine) { return fifthPower(1 - cosine); }
inline Color mix(Color a, Color b, float t) { return a * (1 - t) + b * t; }
inline float mix(float a, float b, float t) { return a * (1 - t) + b * t; }
inline float luminance(Color c) { return 0.212671f * c.r + 0.715160f * c.g + 0.072169f * c.b; }
/// The hue of a colour at luminance 1.
inline Color tintOf(Color c) {
  const float l = luminance(c);
  return l > 0 ? c / l : Color(1);
}

/// Schlick's curve from r0; from the denser side by the angle on the other one.
inline Color schlick(Color r0, float cosine, float eta) {
  if (eta > 1) return mix(r0, Color(1), grazing(cosine));
  return mix(r0, Color(1), grazing(std::sqrt(std::max(0.0f, 1 - (1 - cosine * cosine) / (eta * eta)))));
}

inline float facingReflectance(float eta) {
  const float r = (eta - 1) / (eta + 1);
  return r * r;
}

/// Widths of the slopes along and across (2012, section 5.4).
inline std::array<float, 2> widths(float anisotropic, float roughness) {
  const float square = roughness * roughness, aspect = std::sqrt(1 - 0.9f * anisotropic);
  return {std::max(0.001f, square / aspect), std::max(0.001f, square * aspect)};
}

struct Sheet {
  float roughness, flatness, sheen, sheenTint;
};

/// f of diffuse reflection with its retro-reflection (2015, equation 4), flattened towards scattering below a thin
/// surface (2012, section 5.3, after Hanrahan and Krueger), and of the sheen. `half` is the cosine between light and
/// halfway vector.
inline Color diffuse(const Sheet& sheet, Color base, float viewer, float light, float half) {
  constexpr float inversePi = 0.31830988618f;
  const float fv = grazing(viewer), fl = grazing(light);
  const float retro = 2 * sheet.roughness * half * half;
  const float plain = (1 - 0.5f * fv) * (1 - 0.5f * fl) + retro * (fv + fl + fv * fl * (retro - 1));
  const float f90 = 0.5f * retro;
  const float below = mix(1, f90, fl) * mix(1, f90, fv);
  const float flat = 1.25f * (below * (1 / (viewer + light) - 0.5f) + 0.5f);
  const Color sheen = mix(Color(1), tintOf(base), sheet.sheenTint) * (sheet.sheen * grazing(half));
  return base * (inversePi * mix(plain, flat, sheet.flatness)) + sheen;
}

}  // namespace aerosol::render::disney

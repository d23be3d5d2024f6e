// The lobe of Henyey and Greenstein (1941), which other phase functions build on.
//
//   p(cos) = (1 - g²) / (4π (1 + g² - 2 g cos)^(3/2)),   g the mean cosine, cos between directions of travel.
//
// The textbook inversion divides by g and loses all digits as g → 0 or |g| → 1. With u = 2ξ - 1 the polynomials factor:
//   1 - cos = (1 - g)² (1 - u) (1 + (1 + u) g / 2) / (1 + g u)²
//   1 + cos = (1 + g)² (1 + u) (1 - (1 - u) g / 2) / (1 + g u)²
// in which nothing cancels, for every g in (-1, 1), 0 included. For the same reason the density takes
//   1 + g² - 2 g cos = (1 - |g|)² + 2 |g| (1 ∓ cos).
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "core/volume/phase.h"

namespace aerosol::render::hg {

/// Above this |g| all light goes straight on (or back): the peak is narrower than what directions in float resolve.
inline constexpr double deltaLimit = 1 - 0x1p-20;

/// Per steradian, for |g| < 1.
inline double density(double g, const volume::Deflection& deflection) {
  const double size = std::fabs(g);
  const double away = g > 0 ? deflection.oneMinusCosine : deflection.onePlusCosine;
  const double d = (1 - size) * (1 - size) + 2 * size * away;
  return (1 - size) * (1 + size) / (4 * std::numbers::pi * d * std::sqrt(d));
}

/// The deflection below which a share ξ of all light is turned farther: `onePlusU` = 2ξ, `oneMinusU` = 2 (1 - ξ).
inline volume::Deflection deflectionAt(double g, double onePlusU, double oneMinusU) {
  const double denominator = g > 0 ? 1 - g + g * onePlusU : 1 + g - g * oneMinusU;
  const double a = (1 - g) / denominator, b = (1 + g) / denominator;
  return {a * a * oneMinusU * (1 + 0.5 * g * onePlusU), b * b * onePlusU * (1 - 0.5 * g * oneMinusU)};
}

/// The direction that is turned by `deflection` out of the unit vector `before`; `v` in [0, 1) is the azimuth.
inline Vector<World> turned(Vector<World> before, const volume::Deflection& deflection, float v) {
  const double sine = std::sqrt(deflection.oneMinusCosine * deflection.onePlusCosine);
  const double phi = 2 * std::numbers::pi * static_cast<double>(v);
  const Frame<World> frame(before);
  return normalize(frame.at(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
                            static_cast<float>(deflection.cosine())));
}

}  // namespace aerosol::render::hg

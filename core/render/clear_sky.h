// The sun and the clear sky of Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight" (1999).
#pragma once

#include <array>

#include "core/base/color.h"

namespace aerosol::render {

/// Colours are linear Rec.709 of spectral radiance, W / (m² sr nm): an even spectrum of 1 has the luminance 1. Some
/// have channels below zero, outside of the triangle of Rec.709: they become zero here.
class ClearSky {
 public:
  /// The sun's angle from the zenith in [0, π/2] (radians); turbidity from 1.7 to 10.
  ClearSky(double sunZenith, double turbidity);

  /// Towards a direction by the cosine to the zenith, in [0, 1], and the angle to the sun (radians).
  Color sky(double cosZenith, double sunAngle) const;
  /// Luminance of the same.
  double luminance(double cosZenith, double sunAngle) const;
  /// The mean of the sun's disc, through the air.
  Color sun() const;

 private:
  /// One of Y, x, y: zenith value over F(0, θs), and the five coefficients of Perez, Seals and Michalsky (1993).
  struct Channel {
    double scale = 0;
    std::array<double, 5> perez{};
    double operator()(double cosZenith, double sunAngle) const;
  };

  double zenith_, turbidity_;
  Channel Y_, x_, y_;
};

}  // namespace aerosol::render

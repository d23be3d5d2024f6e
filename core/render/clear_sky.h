// The clear sky of Hosek and Wilkie, "An Analytic Model for Full Spectral Sky-Dome Radiance" (2012), and the sun of the
// same, "Adding a Solar-Radiance Function to the Hosek-Wilkie Skylight Model" (2013), as Mitsuba 3 has them.
#pragma once

#include <array>

#include "core/base/color.h"

namespace aerosol::render {

/// Colours are linear Rec.709 of spectral radiance, W / (m² sr nm): an even spectrum of 1 has the luminance 1. Some
/// have channels below zero, outside of the triangle of Rec.709: they become zero here.
class ClearSky {
 public:
  /// Degrees across the sun.
  static constexpr double aperture = 0.5358;

  /// The sun's angle from the zenith in [0, π/2] (radians); turbidity from 1 to 10; albedo of the ground in [0, 1].
  ClearSky(double sunZenith, double turbidity, Color albedo);

  /// Towards a direction by the cosine to the zenith, in [0, 1], and the angle to the sun (radians).
  Color sky(double cosZenith, double sunAngle) const;
  /// The mean of the sun's disc, through the air.
  Color sun() const { return sun_; }
  /// A point of the disc relative to its mean: it is darker towards its limb. The sine of the angle from its centre
  /// over that of its edge, in [0, 1].
  static Color limbDarkening(double sine);

 private:
  std::array<std::array<double, 9>, 3> shape_{};
  std::array<double, 3> mean_{};
  Color sun_;
};

}  // namespace aerosol::render

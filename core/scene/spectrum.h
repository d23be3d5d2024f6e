// Spectra as colours of the working space.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/color.h"
#include "core/scene/value.h"

namespace aerosol::scene {

/// Values by wavelength in nm, ascending; linear between them, nothing outside.
struct Spectrum {
  std::vector<double> wavelengths_nm, values;

  double operator()(double wavelength_nm) const;
};

/// What it stands for: light of its own, or a factor of light.
enum class SpectrumUse : std::uint8_t { emitted, factor };

/// Linear Rec.709. Of emitted light, per nm, the integral over the CIE 1931 observer by that of its y; of a factor the
/// same in daylight (D65), so that 1 is white. A factor's channels are not negative.
Color colorOf(const std::function<double(double wavelength_nm)>& spectrum, SpectrumUse use);

/// Radiance of a black body, W / (m² sr nm) (Planck's law).
double blackbodyRadiance(double wavelength_nm, double temperature_K);

/// `400:0.1, 500:0.3 …`: at least two pairs of wavelength and value, ascending.
std::optional<Spectrum> parseSpectrum(std::string_view text, TextError& error);

}  // namespace aerosol::scene

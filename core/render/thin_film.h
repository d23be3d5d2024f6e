// Interference in a thin film on a boundary.
#pragma once

#include "core/base/color.h"

namespace aerosol::render {

/// A film of a transparent matter. Without thickness there is none.
struct ThinFilm {
  float thickness_nm = 0;
  float ior = 1.5f;  ///< Over that of the near side.

  bool isThere() const { return thickness_nm > 0 && ior > 0; }
};

/// What a film on a base reflects of unpolarised light, each channel in [0, 1]. `cosine` >= 0 is that of the direction
/// on the near side, `eta` + i `k` the index of the base by channel, all over that of the near side.
///
/// Belcour and Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence": Airy's
/// sum of all reflections as a Fourier series in the phase, of which each term is integrated over the sensitivity of
/// the eye in closed form. Three terms; what they leave of red, green or blue outside of [0, 1] is cut off.
Color filmReflectance(const ThinFilm& film, float cosine, Color eta, Color k);

}  // namespace aerosol::render

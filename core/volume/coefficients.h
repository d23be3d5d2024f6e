// What a volume shader says of a point: extinction, scattering, emission and phase.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/color.h"

namespace aerosol::volume {

inline constexpr int maximumLobes = 4;  ///< Scattering lobes of one shader.

/// One phase lobe: a Henyey–Greenstein phase function with its share of the scattering coefficient.
struct Lobe {
  Color sigmaS;          ///< Per scene unit.
  float anisotropy = 0;  ///< Mean cosine in [-1, 1].
};

/// Coefficients of one medium at one point, per scene unit. `sigmaS` is the sum over the lobes.
struct Coefficients {
  Color sigmaT;
  Color sigmaS;
  Color emission;  ///< Radiance per scene unit.
  std::array<Lobe, maximumLobes> lobes{};
  std::uint32_t lobeCount = 0;
};

/// Where a bound on extinction comes from.
enum class Provenance : std::uint8_t {
  proven,     ///< Ranges of the program, a constant program, voxel minima and maxima.
  declared,   ///< By the scene or by the shader's metadata.
  estimated,  ///< Sampled, with a margin.
};

/// An upper bound on the largest channel of extinction over a region.
struct ExtinctionBound {
  float value = 0;
  Provenance provenance = Provenance::declared;
};

}  // namespace aerosol::volume

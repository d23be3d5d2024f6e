// The lights beside a ray as a table of marching takes them in: their falloff over any part of the ray, in closed form.
#pragma once

#include <array>
#include <cstddef>

#include "core/volume/distance_sample.h"
#include "core/volume/equiangular.h"

namespace aerosol::volume {

/// A light, or a cluster of them, beside a ray.
struct LightColumn {
  double projection = 0;  ///< Where along the ray it is nearest.
  double distance = 0;    ///< How far away it is there, kept from 0 as for equiangular sampling.
  double intensity = 0;   ///< At least 0.

  double falloff(double t) const {
    const double x = t - projection;
    return intensity / (distance * distance + x * x);
  }
  EquiangularStretch over(double t0, double t1) const { return {distance, t0 - projection, t1 - projection}; }
};

/// Few of them. A small value.
struct LightColumns {
  static constexpr std::size_t most = 16;

  std::array<LightColumn, most> columns{};
  std::size_t count = 0;
};

/// A distance that is found on the way, in proportion to σs T and to the light of columns: joint importance sampling by
/// the ray's table (Kulla 2019, "Path Tracing in Production – Volumes", the slide behind that of the table's lookup).
///
/// Each cell of a table has for each column the mass m = W ∫ I dt / (D² + t²), with W the mean of the cell's mix(σs T).
/// Of several tables along the ray one gives the place, in proportion to its mass (reservoir sampling); the light is
/// chosen with the place, by its share of the cell's mass, and the place within the cell by the light's falloff. The
/// joint density is then W I / (D² + t²) over the sum of all masses, for any place and light of the ray: `scale` keeps
/// W, of the place that was found here, and DistanceSample::lightScale of the one that the tracker found.
struct TabulatedLight {
  const LightColumns* columns = nullptr;
  std::array<float, 2> u{};  ///< In [0, 1): which place.

  double mass = 0;         ///< Of all tables so far.
  double scale = 0;        ///< Of the place found.
  std::size_t column = 0;  ///< The light found,
  DistanceSample found;    ///< and what scatters there, as GivenDistance::sample tells it; `passed`: nothing.
};

}  // namespace aerosol::volume

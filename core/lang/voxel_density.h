// Volume shaders whose coefficients are one value of a voxel grid times constants: what is needed to solve their
// transport in closed form, voxel by voxel.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/lang/analysis.h"

namespace aerosol::lang {

/// A lookup of a grid at P in the space "object", outside of which the coefficients are 0.
struct VoxelLookup {
  std::string file, grid, interpolation;
  int channel = 0;
  float time = 0;

  bool operator==(const VoxelLookup&) const = default;
};

/// Coefficients for a value of 1, as `Program::outputs` names them; they are in proportion to the value.
struct VoxelDensity {
  VoxelLookup lookup;
  std::array<float, 3> sigmaT{}, sigmaS{}, emission{};
  struct Lobe {
    std::array<float, 3> sigmaS{};
    float anisotropy = 0;
  };
  std::vector<Lobe> lobes;
  /// Largest value up to which, from 0, the proportion holds; infinite where nothing is clamped.
  float largestValue = 0;
};

/// What a volume shader computes for the given parameters, if that is all it is. Values below 0 are not asked about.
std::optional<VoxelDensity> findVoxelDensity(const Program& program, const ParameterValues& values);

}  // namespace aerosol::lang

// Sparse voxel data into OpenVDB files.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace aerosol::grid {

/// 8 x 8 x 8 voxels. Those whose channels are all 0 are not active.
struct VoxelBlock {
  std::array<std::int32_t, 3> origin{};  ///< The least index; multiples of 8.
  std::vector<float> values;             ///< `channels` numbers a voxel, z fastest: ((x * 8 + y) * 8 + z).
};

/// A grid to write; its background is 0.
struct NewGrid {
  std::string name;
  int channels = 1;                         ///< 1 or 3.
  std::array<double, 16> indexToFile = {};  ///< Row-major, for column vectors; affine.
  bool isFog = false;                       ///< A density.
  std::vector<VoxelBlock> blocks;           ///< No two of the same place.
};

/// Writes a file with these grids. Values are kept as 16-bit floats where `asHalf`. Errors name the file.
Diagnostics writeGrids(const std::string& path, std::span<const NewGrid> grids, bool asHalf);

}  // namespace aerosol::grid

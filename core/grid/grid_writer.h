// Sparse voxel data into OpenVDB files.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
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

/// How voxels stand in a frustum.
struct NewFrustum {
  /// With depth in even steps: OpenVDB's NonlinearFrustumMap (see VoxelMap::linearDepth).
  std::array<double, 3> least{}, greatest{};  ///< Of the box around the voxels, index space.
  double taper = 1;                           ///< Width at the near end by that at the far end.
  double depth = 1;
  std::array<double, 16> secondToFile{};  ///< Row-major, for column vectors; affine.
  /// Instead: the index is (x, y, z) / w of this matrix times (point, 1). OpenVDB has no such map: the matrix stands in
  /// the grid's metadata "aerosol_file_to_index", row after row of its columns as OpenVDB multiplies row vectors, and
  /// the grid's own map is the identity.
  std::optional<std::array<double, 16>> fileToIndex;
};

/// A grid to write; its background is 0.
struct NewGrid {
  std::string name;
  int channels = 1;                         ///< 1 or 3.
  std::array<double, 16> indexToFile = {};  ///< Row-major, for column vectors; affine.
  std::optional<NewFrustum> frustum;        ///< Instead.
  bool isFog = false;                       ///< A density.
  std::vector<VoxelBlock> blocks;           ///< No two of the same place.
};

/// Writes a file with these grids. Values are kept as 16-bit floats where `asHalf`. Errors name the file.
Diagnostics writeGrids(const std::string& path, std::span<const NewGrid> grids, bool asHalf);

}  // namespace aerosol::grid

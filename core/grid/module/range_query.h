// What lookups can give in a box. Internal to the module.
#pragma once

#include <array>

#include "core/base/voxel_grid.h"
#include "core/grid/module/directory.h"

namespace aerosol::grid {

/// `fileToIndex`: 12 numbers, rows of a map on column vectors.
VoxelRange findRange(const Directory& directory, const double* fileToIndex, VoxelInterpolation interpolation,
                     const std::array<double, 3>& lower, const std::array<double, 3>& upper, int channel);
/// The same for voxels in a frustum.
VoxelRange findRange(const Directory& directory, const VoxelMap& map, VoxelInterpolation interpolation,
                     const std::array<double, 3>& lower, const std::array<double, 3>& upper, int channel);

/// A range of stored values widened by what interpolation rounds.
VoxelRange widened(const ValueRange& range, VoxelInterpolation interpolation);

}  // namespace aerosol::grid

// What stands in a file of voxel grids, for people.
#pragma once

#include <string>

#include "core/base/voxel_grid.h"

namespace aerosol::app {

/// A few lines for each grid: type, active voxels, bounds, size of a voxel, values, and which of these are no numbers.
std::string describeVoxels(const std::string& path, const VoxelFile& file);

}  // namespace aerosol::app

// One grid of a file. Internal to the module.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>

#include "core/base/voxel_grid.h"

namespace aerosol::grid {

/// Metadata of grids whose inactive values repeat the active ones beside them: what is wrong with those is not counted
/// again.
inline constexpr const char* paddedName = "aerosol_padded";

/// Values converted to floats in NanoVDB's form, or a grid with `info().problem` set. May throw what OpenVDB throws.
std::unique_ptr<VoxelGrid> makeGrid(const openvdb::GridBase& grid);

}  // namespace aerosol::grid

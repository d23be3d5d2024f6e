// Voxel data of OpenVDB and Mitsuba files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/voxel_grid.h"

namespace aerosol::grid {

/// Whether the name's extension says that it is such a file: .vdb or .vol in any case.
bool isGridFile(std::string_view path);

/// Reads all grids of a file. Values of type float, half, double, int32, int64 and of vectors of three of these can be
/// looked up, under any affine map; other grids are there with `problem` set. A .vol file is one dense grid without a
/// name, of one or three channels, over the box that the file gives; up to the box's faces the outermost voxels hold.
/// Loads the libraries. Errors name the file.
Result<std::shared_ptr<const VoxelFile>> readGrids(const std::string& path);

/// "OpenVDB 10.0.1" and the like. Loads the libraries.
Result<std::vector<std::string>> libraryVersions();

}  // namespace aerosol::grid

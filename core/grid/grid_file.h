// Voxel data of files: OpenVDB's, Mitsuba's, and those of voxels in time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/voxel_grid.h"

namespace aerosol::grid {

/// Whether the name's extension says that it is such a file: .vdb, .vol or .avt in any case.
bool isGridFile(std::string_view path);

/// A name for a file of which the vector grid `grid` goes on for `voxels` beyond its active ones, with the values at
/// its rim: velocities of what is carried out of a cloud. `isGridFile` and `readGrids` take it as they take the file's.
std::string continuedName(std::string_view path, std::string_view grid, int voxels);
/// A name for a file of which all grids have voxels 2^level times as long: for light that needs no detail. Kinds of
/// grids that cannot be coarser are what they are. A part of it follows "?level=".
std::string coarseName(std::string_view path, int level);
/// A name for a file whose grids lie in the unit cube, each with the box of its active voxels. Shaders append it too.
inline constexpr std::string_view unitCubeSuffix = "?unit";
/// The file's own name of such a name, and of any other.
std::string_view fileOfName(std::string_view name);

/// What such a name asks for.
struct VoxelFileName {
  std::string path;
  std::string continuedGrid;  ///< See continuedName.
  int continuedVoxels = 0;
  bool isUnit = false;
  int level = 0;
};

/// Reads all grids of a file. Values of type float, half, double, int32, int64 and of vectors of three of these can be
/// looked up, under any affine map; other grids are there with `problem` set. A .vol file is one dense grid without a
/// name, of one or three channels, over the box that the file gives; up to the box's faces the outermost voxels hold.
/// Loads the libraries. Errors name the file.
Result<std::shared_ptr<const VoxelFile>> readGrids(const std::string& path);

/// "OpenVDB 10.0.1" and the like. Loads the libraries.
Result<std::vector<std::string>> libraryVersions();

}  // namespace aerosol::grid

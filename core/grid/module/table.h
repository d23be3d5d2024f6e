// What the module of voxel libraries offers the program. Both are of one build; no function throws.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/voxel_grid.h"
#include "core/grid/grid_file.h"
#include "core/grid/grid_writer.h"

namespace aerosol::grid {

struct ModuleTable {
  /// Null, with a message, when the file cannot be read.
  std::unique_ptr<const VoxelFile> (*read)(const VoxelFileName& name, std::string& message);
  std::vector<std::string> (*versions)();
  /// What went wrong; empty after success.
  std::string (*write)(const std::string& path, std::span<const NewGrid> grids, bool asHalf);
};

/// The name and type of the module's only exported function.
constexpr const char* moduleTableName = "aerosolGridModule";
using ModuleTableFunction = const ModuleTable*();

}  // namespace aerosol::grid

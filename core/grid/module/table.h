// What the module of voxel libraries offers the program. Both are of one build; no function throws.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/voxel_grid.h"

namespace aerosol::grid {

struct ModuleTable {
  /// Null, with a message, when the file cannot be read.
  std::unique_ptr<const VoxelFile> (*read)(const std::string& path, std::string& message);
  std::vector<std::string> (*versions)();
};

/// The name and type of the module's only exported function.
constexpr const char* moduleTableName = "aerosolGridModule";
using ModuleTableFunction = const ModuleTable*();

}  // namespace aerosol::grid

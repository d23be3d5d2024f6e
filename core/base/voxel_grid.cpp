#include "core/base/voxel_grid.h"

namespace aerosol {

const VoxelGrid* VoxelFile::find(std::string_view name) const {
  for (const auto& grid : grids()) {
    if (name.empty() ? grid->info().channels > 0 : grid->info().name == name) return grid.get();
  }
  return nullptr;
}

}  // namespace aerosol

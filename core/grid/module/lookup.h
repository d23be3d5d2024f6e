// Interpolated values of many points. Internal to the module.
#pragma once

#include "core/base/voxel_grid.h"
#include "core/grid/lanes.h"
#include "core/grid/module/directory.h"

namespace aerosol::grid {

/// The instruction set is chosen by what the processor has; all of them give the same bits.
void lookUp(VoxelInterpolation interpolation, const Directory& directory, const LookupPoints& points);

}  // namespace aerosol::grid

// The module of voxel libraries. Internal to this folder.
#pragma once

#include "core/base/result.h"
#include "core/grid/module/table.h"

namespace aerosol::grid {

/// Opened by the first call.
const Result<const ModuleTable*>& moduleTable();

}  // namespace aerosol::grid

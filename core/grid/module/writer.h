// Writing OpenVDB files. Internal to the module.
#pragma once

#include "core/grid/grid_writer.h"

namespace aerosol::grid {

/// What went wrong; empty after success.
std::string write(const std::string& path, std::span<const NewGrid> grids, bool asHalf);

}  // namespace aerosol::grid

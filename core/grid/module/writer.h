// Writing OpenVDB files. Internal to the module.
#pragma once

#include "core/grid/grid_writer.h"

namespace aerosol::grid {

/// The metadata with the map of grids whose voxels stand in a projective frustum: see NewFrustum.
inline constexpr const char* projectionName = "aerosol_file_to_index";

/// What went wrong; empty after success.
std::string write(const std::string& path, std::span<const NewGrid> grids, bool asHalf);

}  // namespace aerosol::grid

// Files of voxels, told from images by their names.
#pragma once

#include <string_view>

namespace aerosol {

/// Whether a path ends as OpenVDB's files do (.vdb), Mitsuba's (.vol) or ours of voxels in time (.avt), in capitals or
/// not.
bool isVoxelFileName(std::string_view path);

}  // namespace aerosol

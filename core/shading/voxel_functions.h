// Lookups of voxel files by texture functions.
#pragma once

#include <optional>
#include <span>

#include "core/shading/services.h"
#include "core/shading/texture_call.h"

namespace aerosol::shading {

VoxelInterpolation voxelInterpolation(TextureInterpolation interpolation);
/// The grid that an option or its absence names; null with a message.
const VoxelGrid* chooseVoxelGrid(const VoxelFile& file, std::string_view path, const TexturePoint& point,
                                 std::string& problem);

/// The lanes of `group` look up a file of voxel data: the grid is chosen by the option "subimage" (a name or a number;
/// the first one that can be looked up without it), at points of the file's space.
void lookUpVoxels(TextureCall& call, ServicesOfThread& services, std::string_view file,
                  std::span<const unsigned> group);

/// Answers of gettextureinfo about a voxel file.
std::optional<TextureInfo> voxelInfo(ServicesOfThread& services, std::string_view file, std::string_view name,
                                     const TextureInfoType& type);

}  // namespace aerosol::shading

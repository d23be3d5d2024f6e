// Voxels that are coarser than their files': where the camera sees them small, and where paths have become long.
//
// A medium whose shader reads voxel files gets a second one with the same shader reading a coarser level of the same
// files, with bounds and methods of its own. So nothing is decided along rays but which of the two is seen.
#pragma once

#include <string>

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Halvings after which the voxels that a volume's shader reads are about as large as the integrator's `lod_pixels`, at
/// the volume's place that is nearest to the camera; 0 where none are to be left out.
int levelByDistance(const Preparation& state, shading::InstanceRef shader);

/// An instance of the same program in the same place that reads its voxel files `level` halvings coarser. Nothing where
/// no parameter names such a file.
std::optional<shading::InstanceRef> coarserShader(Preparation& state, shading::InstanceRef shader, int level);

/// Adds to the reasons of media which levels are read, and what that changes: the transmittance of lines through the
/// volume, beside the same lines through what the files say. After the media were decided.
void reportLevelsOfDetail(Preparation& state);

}  // namespace aerosol::render

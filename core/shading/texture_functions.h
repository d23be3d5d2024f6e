// The host functions that look up textures and voxel data.
#pragma once

#include "core/shading/host_functions.h"

namespace aerosol::shading {

void texture(PointCall& call);
void texture3d(PointCall& call);
void environment(PointCall& call);
void getTextureInfo(PointCall& call);

}  // namespace aerosol::shading

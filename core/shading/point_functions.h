// The host functions of point clouds.
#pragma once

#include "core/shading/host_functions.h"

namespace aerosol::shading {

void pointcloudSearch(PointCall& call);
void pointcloudGet(PointCall& call);
void pointcloudWrite(PointCall& call);

}  // namespace aerosol::shading

// What host functions can give over boxes of points.
#pragma once

#include "core/shading/host_functions.h"

namespace aerosol::shading {

/// Both ends of the results of a call over boxes (AerosolHostCall::high) of texture, texture3d or environment: from the
/// least and greatest values of the image, or of the nodes of the grid that the box reaches. NaN where nothing is
/// known.
void boundLookup(PointCall& low, PointCall& high);

}  // namespace aerosol::shading

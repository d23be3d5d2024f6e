// The points of a grid and the spaces around them, as OSL's testshade has them: what shaders written against it expect.
#pragma once

#include "core/app/tools/shade_arguments.h"
#include "core/shading/kernel_host.h"
#include "core/shading/shading_point.h"

namespace aerosol::app {

/// The globals of point (x, y), counted from 0.
shading::ShadingPoint gridPoint(const ShadeGrid& grid, int x, int y);

/// "object" to "common": a quarter turn about z, then one unit along y.
Transform<World, Object> gridObjectSpace();
/// "shader" to "common": an eighth of a turn about z, then one unit along x.
Transform<World, Object> gridShaderSpace();

/// "camera" is "common"; "myspace" is twice as high as "common".
shading::NamedSpaces gridSpaces();

}  // namespace aerosol::app

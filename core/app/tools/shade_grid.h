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

/// Clip planes of the camera, whose angle of view is 90 degrees.
inline constexpr float nearClip = 0.1f, farClip = 1000;

/// "camera" is "common"; "screen", "NDC" and "raster" are those of the camera; "myspace" is twice as high as "common".
shading::NamedSpaces gridSpaces(const ShadeGrid& grid);

}  // namespace aerosol::app

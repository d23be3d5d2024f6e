// AOVs of the surface that a camera ray meets first, whatever it is made of.
#pragma once

#include "core/render/camera.h"
#include "core/render/path_context.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// A ray query of its own, and where the albedo is asked for a call of the surface's shader: no integrator has to know.
/// Without a surface all values stay 0. The path has a record; `camera` made the ray.
volume::Task<> recordFirstHit(PathContext& path, CameraSample camera, Ray<World> ray);

}  // namespace aerosol::render

// How much of a camera ray ends where: transmittance through media up to the first surface.
#pragma once

#include "core/render/path_context.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// A ray query and estimates of transmittance of its own, slice by slice, with random numbers of their own: the picture
/// stays as it is. The path has a record with a deep one.
volume::Task<> recordDeep(PathContext& path, Ray<World> ray);

}  // namespace aerosol::render

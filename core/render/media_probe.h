// Which interiors a point is in, found while rendering.
#pragma once

#include "core/render/path_context.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// Fills `path.media` with the interiors around a point at a time, as `findMedia` does before the render.
volume::Task<bool> probeMedia(PathContext& path, Point<World> point, float time);

/// Whether the rays of one camera may begin in different media: some surface with an inside comes near to where they
/// begin (lens and near plane).
bool needsProbes(const PreparedScene& scene, Point<World> eye, float reach);

}  // namespace aerosol::render

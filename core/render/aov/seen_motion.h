// By how much what is seen moves in the picture while the shutter is open.
#pragma once

#include <array>

#include "core/accel/scene.h"
#include "core/render/path_context.h"
#include "core/volume/medium.h"

namespace aerosol::render {

/// Pixels from where the camera sees it when the shutter opens to where it sees it when that closes, to the right and
/// down; 0 where it is behind the camera at either time. `time`: of the ray that met it.
std::array<float, 2> motionOf(const PathContext& path, const accel::SurfaceHit& hit, float time);

/// Of matter of a medium, at a place: it moves with the medium's space, and by `velocity`, as the medium's shader or
/// grid gives it (0 where the medium has none).
std::array<float, 2> motionOf(const PathContext& path, const volume::Medium& medium, Point<World> point, float time,
                              Vector<World> velocity);

}  // namespace aerosol::render

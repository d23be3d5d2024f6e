// What a surface's material says about its inside.
#pragma once

#include <optional>

#include "core/render/prepared_scene.h"
#include "core/render/surface_answer.h"
#include "core/volume/medium_stack.h"

namespace aerosol::render {

/// The interior that the closures of one hit describe: the sum of its medium_vdf() terms, with the index and the
/// priority of the first; otherwise the shape's own interior medium with the shape's priority. None where neither says
/// anything: the two sides are one space.
std::optional<volume::Interior> interiorOf(const PreparedScene& scene, std::uint32_t object,
                                           const SurfaceAnswer& answer);

/// Hits in the order of the way up, put in that of the way down: faces that coincide stay in the order of (object,
/// primitive), as any ray crosses them.
void turnDownwards(std::vector<accel::SurfaceHit>& hits);

/// Which interiors a point is in: every surface above it is crossed on the way down from outside of the scene, and
/// asked what is inside. Open surfaces count (a plane of water); upwards is +y.
volume::MediumStack findMedia(const PreparedScene& scene, Point<World> point, float time);

}  // namespace aerosol::render

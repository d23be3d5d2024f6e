// Lights that move while the shutter is open.
#pragma once

#include <memory>

#include "core/base/motion.h"
#include "core/render/light.h"

namespace aerosol::render {

/// A light that stands still in a space that moves. A sample is taken there, at the time that it is for, and brought
/// to the world; its density per solid angle goes by the areas of the two spaces, so motions may stretch surfaces.
/// Radiance and radiant intensity stay what they are. What the choice among lights goes by is a mean over the shutter:
/// the same at all times.
std::unique_ptr<const Light> makeMovingLight(std::unique_ptr<const Light> atRest,
                                             const MovingTransform<World, Object>& placement, const Shutter& shutter);

}  // namespace aerosol::render

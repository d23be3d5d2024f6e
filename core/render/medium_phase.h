// Phase functions that a scene gives a medium.
#pragma once

#include <memory>

#include "core/render/registry.h"
#include "core/scene/description.h"
#include "core/volume/phase.h"

namespace aerosol::render {

/// The phase function as described. Its one parameter is the anisotropy that the medium's shader gives: the weight of a
/// blend that is fed, nothing to others. It may refer to functions of `registry`.
std::shared_ptr<const volume::PhaseFunction> makePhase(const scene::Phase& phase, const Registry& registry);

}  // namespace aerosol::render

// The parts of a scene, looked at one by one.
#pragma once

#include "core/render/prepare.h"

namespace aerosol::render {

/// What is wrong with the shaders, the files and the emitters of a scene, each by itself: unlike `prepare`, which stops
/// where the next step would make no sense. The description may be one that was read with errors. Each problem is told
/// once.
Diagnostics checkParts(const scene::SceneDescription& description, const Registry& registry,
                       const PrepareOptions& options);

}  // namespace aerosol::render

// Slices of a deep image, as a scene is prepared.
#pragma once

#include "core/render/aov/deep_layout.h"
#include "core/render/preparation/state.h"

namespace aerosol::render {

/// So many slices over the depths in which media are, and some for the surfaces in front of them and behind.
AovDeep deepLayout(const Preparation& state, int slices);

}  // namespace aerosol::render

// Lights and their textures, as a scene is prepared.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

void bindLightTextures(Preparation& state);

/// Those of the description, then media that glow.
void addLights(Preparation& state);

}  // namespace aerosol::render

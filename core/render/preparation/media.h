// Media and where they are, as a scene is prepared.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Those of volumes, of shapes and of the camera.
void placeMedia(Preparation& state);

/// Coefficients, bounds and methods of all, once the geometry stands and shaders are compiled.
void decideMedia(Preparation& state);

}  // namespace aerosol::render

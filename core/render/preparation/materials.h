// The shaders of surfaces, as a scene is prepared.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Their instances, one for each shape.
void bindMaterials(Preparation& state);

/// The closures of the renderer behind those of each shader.
void findSiteClosures(Preparation& state);

/// Which closures the material's sites are, and whether it lets everything through.
void describeMaterial(Preparation& state, PreparedObject& object);

}  // namespace aerosol::render

// The files that shaders of a scene are given.
#pragma once

#include "core/base/diagnostic.h"
#include "core/render/prepared_scene.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// A warning for each parameter that names a texture, voxels or points which cannot be read, at the place of its value:
/// shaders find out while they run, and each goes on with what the language has for that. Names that stand for several
/// files are left to the shaders.
Diagnostics examineFiles(const scene::SceneDescription& description, const render::PreparedScene& scene);

}  // namespace aerosol::app

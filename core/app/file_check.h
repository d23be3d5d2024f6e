// The files that shaders of a scene are given.
#pragma once

#include "core/base/diagnostic.h"
#include "core/render/prepared_scene.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// An error for voxels that a call of texture3d is sure to name and that are not there: a missing or damaged file, or
/// no such grid in it; but for calls that say what else they want (`missingcolor`, `errormessage`). A warning for each
/// parameter that names a texture or points which cannot be read: shaders find out while they run, and each goes on
/// with what the language has for that. All at the places of the values in the scene. Names that stand for several
/// files are left to the shaders.
Diagnostics examineFiles(const scene::SceneDescription& description, const render::PreparedScene& scene);

}  // namespace aerosol::app

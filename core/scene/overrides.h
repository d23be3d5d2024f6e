// `--set target.parameter=value`: changes a scene after it was read.
#pragma once

#include <string>

#include "core/scene/description.h"
#include "core/scene/parameter.h"
#include "core/scene/reporter.h"

namespace aerosol::scene {

/// Applies one assignment. The target is an id; else a type or a shader's name, `cumulus.density=2`; else a kind,
/// `film.width=640`; each reaches all objects of that name. `*` reaches every object that knows the parameter, and
/// every shader for which the scene writes it. A shader named otherwise takes any parameter: its interface decides
/// later. A target or parameter that does not exist and a wrong value are errors, without effect.
void applyOverride(SceneDescription& scene, const std::string& assignment, const KnownTypes& known, Reporter& reporter);

}  // namespace aerosol::scene

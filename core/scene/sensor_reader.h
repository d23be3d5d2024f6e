// Sensors with their film and sampler: of several, the one that looks.
#pragma once

#include <string>

#include "core/scene/description.h"
#include "core/scene/element.h"
#include "core/scene/id_table.h"
#include "core/scene/reporter.h"
#include "core/scene/shader_builder.h"

namespace aerosol::scene {

/// Reads all sensors of the scene, and takes the one that is `wanted` by its id or its number from 0 on. Where nobody
/// says, it is the first; that there are others is a warning then.
void readSensors(const SceneTree& tree, const std::string& wanted, IdTable& ids, ShaderBuilder& shaders,
                 Reporter& reporter, SceneDescription& scene);

}  // namespace aerosol::scene

// Parameters of the emitters that take many.
#pragma once

#include <vector>

#include "core/scene/field.h"

namespace aerosol::scene {

/// A placement that cannot be animated: of lights that surround the scene.
Field<Emitter> standing(Field<Emitter> placement);

std::vector<Field<Emitter>> projectorFields();
std::vector<Field<Emitter>> sunSkyFields();

}  // namespace aerosol::scene

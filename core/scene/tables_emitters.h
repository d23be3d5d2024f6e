// Parameters of the emitters that take many.
#pragma once

#include <vector>

#include "core/scene/field.h"

namespace aerosol::scene {

std::vector<Field<Emitter>> projectorFields();
std::vector<Field<Emitter>> sunSkyFields();

}  // namespace aerosol::scene

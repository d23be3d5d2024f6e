// AOVs, as a scene is prepared.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// When lights are there.
void decideAovs(Preparation& state);

}  // namespace aerosol::render

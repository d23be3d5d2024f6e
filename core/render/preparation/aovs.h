// AOVs, as a scene is prepared.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// When media are placed and nothing is compiled: asks for kernels of the outputs that AOVs show.
void showOutputs(Preparation& state);
/// When lights are there.
void decideAovs(Preparation& state);

}  // namespace aerosol::render

// The pilot by which Russian roulette knows what paths may still bring.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Renders it where the scene calls for it; the scene is ready but for that, and for what it gathers beside the
/// picture.
void learnContributions(Preparation& state);

}  // namespace aerosol::render

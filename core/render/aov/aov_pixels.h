// Layers of a film as pixels.
#pragma once

#include <vector>

#include "core/render/film.h"

namespace aerosol::render {

/// Row by row, channels interleaved. The layer is one of the film's layout.
std::vector<float> layerPixels(const Film& film, const AovLayer& layer);

}  // namespace aerosol::render

// What shaders say while a grid is shaded, in the form of OSL's testshade.
#pragma once

#include <string>
#include <vector>

#include "core/app/console.h"
#include "core/app/tools/shade_run.h"

namespace aerosol::app {

/// Where a message comes from, as reports name it.
struct ShadedPlace {
  std::string group, layer, shader;
  int layerNumber = 0;
};

/// Printed text goes to the output stream; warnings and errors, each different one once, to the error stream. Both stay
/// in order where the streams end in one place.
void printShadedMessages(const std::vector<ShadedMessage>& messages, const ShadedPlace& place, const Console& console);

}  // namespace aerosol::app

// The outputs that a command line asks for: printed, or written to images.
#pragma once

#include <string>
#include <vector>

#include "core/app/console.h"
#include "core/app/tools/shade_arguments.h"
#include "core/app/tools/shade_run.h"

namespace aerosol::app {

/// "Pixel (x, y):" and a line an output, for all points. `chosen` are indices into `shaded.outputs`.
void printShadedValues(const ShadeGrid& grid, const Shaded& shaded, const std::vector<std::size_t>& chosen,
                       const Console& console);

/// Writes an output to an image file; .jpg, .png and .gif with the sRGB curve. `dataFormat` as in ShadeArguments.
Diagnostics writeShadedImage(const ShadeGrid& grid, const ShadedOutput& output, const std::string& file,
                             const std::string& dataFormat);

}  // namespace aerosol::app

// The outputs that a command line asks for: printed, or written to images.
#pragma once

#include <string>
#include <vector>

#include "core/app/console.h"
#include "core/app/tools/shade_arguments.h"
#include "core/app/tools/shade_run.h"

namespace aerosol::app {

/// An output that is printed.
struct PrintedOutput {
  std::string label;
  std::size_t index = 0;  ///< In `Shaded::outputs`.
};

/// "Pixel (x, y):" and a line an output, for all points.
void printShadedValues(const ShadeGrid& grid, const Shaded& shaded, const std::vector<PrintedOutput>& printed,
                       const Console& console);

/// Writes an output to an image file; .jpg, .png and .gif with the sRGB curve. `dataFormat` as in ShadeArguments.
Diagnostics writeShadedImage(const ShadeGrid& grid, const ShadedOutput& output, const std::string& file,
                             const std::string& dataFormat);

}  // namespace aerosol::app

// `aerosol render`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Reads the scene, renders it, writes the images and what the shaders had to say. What can be wrong with the outputs
/// is found before the render. When interrupted, the samples so far are written.
ExitCode renderCommand(const RenderArguments& arguments, const Console& console);

}  // namespace aerosol::app

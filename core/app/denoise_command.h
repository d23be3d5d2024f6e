// aerosol denoise: noise removed from a finished render.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

ExitCode denoiseCommand(const DenoiseArguments& arguments, const Console& console);

}  // namespace aerosol::app

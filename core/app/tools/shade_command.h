// `aerosol shade`: shaders on a grid of points.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

ExitCode shadeCommand(const ToolArguments& arguments, const Console& console);

}  // namespace aerosol::app

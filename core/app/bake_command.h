// aerosol bake: a volume shader's density into voxels.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

ExitCode bakeCommand(const BakeArguments& arguments, const Console& console);

}  // namespace aerosol::app

// `aerosol compile`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Compiles each shader with its default parameters for this machine. Messages go to the error output; each shader that
/// compiles gets a line on the standard output.
ExitCode compileCommand(const CompileArguments& arguments, const Console& console);

}  // namespace aerosol::app

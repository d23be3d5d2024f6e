// The program.
#pragma once

#include <string>
#include <vector>

#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Runs the command that `arguments` ask for; `program` is the name that the program was called by, which may be that
/// of a tool.
ExitCode run(const std::string& program, const std::vector<std::string>& arguments, const Console& console);

}  // namespace aerosol::app

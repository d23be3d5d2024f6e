// The program.
#pragma once

#include <string>
#include <vector>

#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Runs the command that `arguments` (without the program's name) ask for.
ExitCode run(const std::vector<std::string>& arguments, const Console& console);

}  // namespace aerosol::app

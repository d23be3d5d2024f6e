// `aerosol check`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Tells everything that is wrong with a scene at once: what cannot be read, unknown objects and parameters, shaders
/// that do not compile, files that are missing or damaged. Renders nothing. Success when there are no errors.
ExitCode checkCommand(const CheckArguments& arguments, const Console& console);

}  // namespace aerosol::app

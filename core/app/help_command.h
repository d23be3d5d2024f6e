// `aerosol help`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Help on a topic: a command, "scene", an element or object type of the scene format, or a shader of the search path.
/// An unknown topic is an error that lists what is near.
ExitCode helpCommand(const HelpArguments& arguments, const Console& console);

}  // namespace aerosol::app

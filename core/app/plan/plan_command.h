// `aerosol plan`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Prepares the scene, renders a few samples of a small film, and prints every effect: on or off, why, and its share of
/// the cost.
ExitCode planCommand(const PlanArguments& arguments, const Console& console);

}  // namespace aerosol::app

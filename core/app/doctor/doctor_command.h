// `aerosol doctor`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Looks through a scene for what will go wrong, each finding with its place and what helps; renders a small film to
/// see what shaders do. Success when nothing is found.
ExitCode doctorCommand(const DoctorArguments& arguments, const Console& console);

}  // namespace aerosol::app

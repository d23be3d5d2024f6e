// `aerosol --version`.
#pragma once

#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// "0.1.0"
const char* programVersion();

/// The program's version and those of all libraries that it works with, one a line. A library that cannot be loaded is
/// an error, after the versions of the others.
ExitCode versionCommand(const Console& console);

}  // namespace aerosol::app

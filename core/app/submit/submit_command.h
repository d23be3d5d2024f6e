// `aerosol submit`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Cuts a render into tasks, writes the files by which Slurm, GNU parallel and OpenCue run them, and gives them to
/// Slurm when asked to: an array job, and one that merges after it.
ExitCode submitCommand(const SubmitArguments& arguments, const Console& console);

}  // namespace aerosol::app

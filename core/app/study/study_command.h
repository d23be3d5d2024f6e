// `aerosol study`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Renders the scene in several ways with more and more samples, each several times, and writes what that says about
/// error, bias, noise and time. What is there after an interruption is written, kept and carried on by the next run.
ExitCode studyCommand(const StudyArguments& arguments, const Console& console);

}  // namespace aerosol::app

// `aerosol merge`.
#pragma once

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// Joins the films of the parts, whatever their order, and writes the image. Every part has to be of the same image,
/// and every sample of every pixel has to be there once.
ExitCode mergeCommand(const MergeArguments& arguments, const Console& console);

}  // namespace aerosol::app

// What shaders say while a grid is shaded, in the form of OSL's testshade.
#pragma once

#include <vector>

#include "core/app/console.h"
#include "core/app/tools/shade_group.h"
#include "core/app/tools/shade_run.h"

namespace aerosol::app {

/// Printed text goes to the output stream; warnings and errors, each different one once, to the error stream. Both stay
/// in order where the streams end in one place. What goes to files is added to their ends; gives what went wrong.
Diagnostics printShadedMessages(const std::vector<ShadedMessage>& messages, const ShadeGroup& group,
                                const Console& console);

/// Errors in calls that OSL reports before the group runs, each with its place, once.
void printRemarks(const Diagnostics& remarks, const Console& console);

}  // namespace aerosol::app

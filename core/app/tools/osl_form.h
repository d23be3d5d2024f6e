// Diagnostics in the form of the OSL tools.
#pragma once

#include <string>

#include "core/app/console.h"
#include "core/base/diagnostic.h"

namespace aerosol::app {

/// As oslc writes it: "file:line: error: message", or "error: message" without a place. No line end.
std::string asOslc(const Diagnostic& diagnostic);

/// To the error stream as testshade does it: "WARNING: message"; what was wrong with sources as oslc does it.
void reportAsTestshade(const Diagnostics& diagnostics, const Console& console);

}  // namespace aerosol::app

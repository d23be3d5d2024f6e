// Calls of functions in plugins' shared objects.
#pragma once

#include "core/shading/host_functions.h"
#include "core/shading/native_plugins.h"

namespace aerosol::shading {

/// For points, or (`raw.high` is set) for boxes of points. What the function writes in lanes that make no call is
/// undone.
void callNativeFunction(const ObjectFunction& function, const AerosolHostCall& raw, PointCall& call);

}  // namespace aerosol::shading

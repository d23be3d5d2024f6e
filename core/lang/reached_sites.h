// Which closures of a surface shader can matter.
#pragma once

#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

/// By closure site: whether its weight may be other than black, or it lies on one whose weight may. After `specialise`:
/// of the instances that have the values it was specialised for.
std::vector<bool> reachedSites(const Program& program);

/// Takes out the sites that Ci never holds and that lie on none that it holds, such as what a layering copied. The
/// others are renumbered.
void dropUnheldSites(Program& program);

}  // namespace aerosol::lang

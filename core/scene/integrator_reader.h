// Integrators, which may stand in each other: what goes into the picture, and what is shown beside it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/scene/description.h"
#include "core/scene/element.h"
#include "core/scene/id_table.h"
#include "core/scene/reporter.h"

namespace aerosol::scene {

/// The innermost integrator and the AOVs that those around it ask for.
void readIntegrator(const Element& element, IdTable& ids, Reporter& reporter, Integrator& integrator);

/// The parts of a list between commas or spaces, which count for nothing inside of brackets and quotes.
std::vector<std::string> splitAovList(std::string_view text);

}  // namespace aerosol::scene

// Light passes straight on.

#include "core/render/registry.h"
#include "plugins/closures/straight_on.h"

namespace aerosol::render {

void registerClosure_transparent(Registry& registry) { registry.add(std::make_unique<StraightOn>("transparent")); }

}  // namespace aerosol::render

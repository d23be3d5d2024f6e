// Light passes straight on; the name that MaterialX has for it.

#include "core/render/registry.h"
#include "plugins/closures/straight_on.h"

namespace aerosol::render {

void registerClosure_transparent_bsdf(Registry& registry) {
  registry.add(std::make_unique<StraightOn>("transparent_bsdf"));
}

}  // namespace aerosol::render

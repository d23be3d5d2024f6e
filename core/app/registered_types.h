// What the plugins add to the scene format.
#pragma once

#include "core/render/registry.h"
#include "core/scene/parameter.h"

namespace aerosol::app {

scene::KnownTypes registeredTypes(const render::Registry& registry);

}  // namespace aerosol::app

// The table of all plugins, generated from the list in plugins/CMakeLists.txt.
#pragma once

namespace aerosol::render {

class Registry;

/// Enters every compiled-in plugin, in the order of the list.
void registerPlugins(Registry& registry);

}  // namespace aerosol::render

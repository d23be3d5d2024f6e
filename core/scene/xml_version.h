// The XML library under the scene layer.
#pragma once

#include <string>

namespace aerosol::scene {

/// "pugixml 1.13"
std::string xmlLibraryVersion();

}  // namespace aerosol::scene

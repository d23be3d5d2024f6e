// Filtered texture lookups through OpenImageIO. Internal to the module.
#pragma once

#include <memory>
#include <string>

#include "core/base/texture_source.h"

namespace aerosol::image {

/// See ModuleTable. Null, with a message, when the settings are refused.
std::unique_ptr<TextureSource> makeTextures(const TextureSettings& settings, std::string& message);

}  // namespace aerosol::image

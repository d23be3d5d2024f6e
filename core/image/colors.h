// Colour spaces of OpenColorIO's configurations.
#pragma once

#include <memory>

#include "core/base/color_source.h"
#include "core/base/result.h"

namespace aerosol::image {

/// Loads the image libraries. An error when the configuration cannot be read, or has no such working space.
Result<std::unique_ptr<ColorSource>> openColors(const ColorSettings& settings);

}  // namespace aerosol::image

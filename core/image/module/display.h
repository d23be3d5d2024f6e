// Display transforms through OpenColorIO. Internal to the module.
#pragma once

#include <string>
#include <vector>

#include "core/image/image.h"

namespace aerosol::image {

/// The picture for a display: encoded values, not yet clamped, colours no longer multiplied by alpha.
struct DisplayPicture {
  int channels = 0;  ///< 1 (grey), 3 or 4 (with alpha).
  std::vector<float> pixels;
  bool isSrgb = false;  ///< The display's name says that it is an sRGB one.
};

/// Takes R, G, B and A (or Y) out of `image` and applies exposure and the display transform. Returns an error message;
/// empty when all went well. May throw OpenColorIO's exceptions.
std::string toDisplay(const ImageBuffer& image, const DisplayOptions& options, bool withAlpha, DisplayPicture& picture,
                      WriteReport& report);

}  // namespace aerosol::image

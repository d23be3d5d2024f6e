#include "core/app/pixel_format.h"

#include "core/base/cie_xyz.h"

namespace aerosol::app {

image::ImageBuffer inFormat(const image::ImageBuffer& picture, scene::PixelFormat format) {
  const bool isColor = format == scene::PixelFormat::xyz || format == scene::PixelFormat::xyza;
  const std::size_t before = picture.channels.size();
  image::ImageBuffer converted = picture;
  converted.channels = isColor ? std::vector<std::string>{"X", "Y", "Z"} : std::vector<std::string>{"Y"};
  if (hasAlpha(format)) converted.channels.push_back("A");
  converted.pixels.clear();
  converted.pixels.reserve(picture.pixels.size() / before * converted.channels.size());
  for (std::size_t i = 0; i < picture.pixels.size(); i += before) {
    const float* const pixel = picture.pixels.data() + i;
    const std::array<float, 3> xyz = toXyz({pixel[0], pixel[1], pixel[2]});
    if (isColor) {
      converted.pixels.insert(converted.pixels.end(), xyz.begin(), xyz.end());
    } else {
      converted.pixels.push_back(xyz[1]);
    }
    if (hasAlpha(format)) converted.pixels.push_back(pixel[3]);
  }
  return converted;
}

}  // namespace aerosol::app

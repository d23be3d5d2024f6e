// What our pictures say of themselves, in the terms of OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>

#include <vector>

#include "core/image/image.h"

namespace aerosol::image {

inline void setMetadata(OIIO::ImageSpec& spec, const std::vector<Metadata>& metadata) {
  for (const Metadata& entry : metadata) {
    if (const auto* integer = std::get_if<std::int32_t>(&entry.value)) {
      spec.attribute(entry.key, *integer);
    } else if (const auto* number = std::get_if<double>(&entry.value)) {
      spec.attribute(entry.key, OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE), number);
    } else {
      spec.attribute(entry.key, std::get<std::string>(entry.value));
    }
  }
}

/// Channels, and the place within the whole picture. `image` is an ImageBuffer or a DeepImage.
template <class Image>
OIIO::ImageSpec specOf(const Image& image, OIIO::TypeDesc type) {
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()), type);
  spec.channelnames = image.channels;
  spec.x = image.originX;
  spec.y = image.originY;
  if (image.fullWidth > 0 && image.fullHeight > 0) {
    spec.full_width = image.fullWidth;
    spec.full_height = image.fullHeight;
  } else {
    spec.full_x = image.originX;
    spec.full_y = image.originY;
  }
  return spec;
}

}  // namespace aerosol::image

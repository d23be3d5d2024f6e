#include <OpenImageIO/imageio.h>

#include <exception>

#include "core/image/module/files.h"

namespace aerosol::image {

namespace {

/// Entries that are no text and no single number (matrices, thumbnails) are left out.
void copyMetadata(const OIIO::ImageSpec& spec, std::vector<Metadata>& metadata) {
  for (const OIIO::ParamValue& entry : spec.extra_attribs) {
    const std::string key = entry.name().string();
    const OIIO::TypeDesc type = entry.type();
    if (type == OIIO::TypeDesc::STRING) {
      metadata.push_back({key, entry.get_string()});
    } else if (type == OIIO::TypeDesc::INT) {
      metadata.push_back({key, static_cast<std::int32_t>(entry.get<int>())});
    } else if (type == OIIO::TypeDesc::DOUBLE) {
      metadata.push_back({key, entry.get<double>()});
    } else if (type == OIIO::TypeDesc::FLOAT) {
      metadata.push_back({key, static_cast<double>(entry.get<float>())});
    }
  }
}

std::string read(const std::string& path, ImageBuffer& image) {
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = OIIO::ImageInput::open(path, &hints);
  if (!input) return OIIO::geterror();
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.deep) return "deep images cannot be read here";
  if (spec.depth > 1) return "volumetric images cannot be read here";
  image.width = spec.width;
  image.height = spec.height;
  image.originX = spec.x - spec.full_x;
  image.originY = spec.y - spec.full_y;
  image.fullWidth = spec.full_width;
  image.fullHeight = spec.full_height;
  image.channels = spec.channelnames;
  image.pixels.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                      static_cast<std::size_t>(spec.nchannels));
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data())) {
    return input->geterror();
  }
  copyMetadata(spec, image.metadata);
  return {};
}

}  // namespace

std::string readFile(const std::string& path, ImageBuffer& image) {
  try {
    return read(path, image);
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace aerosol::image

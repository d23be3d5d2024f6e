#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <exception>
#include <vector>

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

std::string readAttachment(OIIO::ImageInput& input, int part, std::string& bytes) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.nchannels != 1 || spec.format != OIIO::TypeDesc::UINT32) return "its attachment has another form";
  std::vector<std::uint32_t> words(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
  if (!input.read_image(part, 0, 0, 1, OIIO::TypeDesc::UINT32, words.data())) return input.geterror();
  if (words.size() < 2) return "its attachment is damaged";
  const std::uint64_t size = words[0] | std::uint64_t{words[1]} << 32;
  if (size > 4 * (words.size() - 2)) return "its attachment is damaged";
  bytes.assign(reinterpret_cast<const char*>(words.data() + 2), size);
  return {};
}

/// Reads the parts behind the picture. Those that show other pixels are left out.
std::string readParts(OIIO::ImageInput& input, ImageBuffer& image) {
  for (int part = 1; input.seek_subimage(part, 0); ++part) {
    const OIIO::ImageSpec& spec = input.spec();
    const std::string name(spec.get_string_attribute("oiio:subimagename"));
    if (name == attachmentName) {
      if (std::string problem = readAttachment(input, part, image.attachment); !problem.empty()) return problem;
      continue;
    }
    const bool isSame = spec.width == image.width && spec.height == image.height && !spec.deep &&
                        spec.x - spec.full_x == image.originX && spec.y - spec.full_y == image.originY;
    if (!isSame) continue;
    ImageLayer& layer = image.layers.emplace_back();
    layer.name = name;
    layer.channels = spec.channelnames;
    copyMetadata(spec, layer.metadata);
    layer.isData = spec.format == OIIO::TypeDesc::FLOAT;
    layer.pixels.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                        static_cast<std::size_t>(spec.nchannels));
    if (!input.read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, layer.pixels.data()))
      return input.geterror();
  }
  static_cast<void>(input.geterror());  // Of looking behind the last part.
  return {};
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
  return readParts(*input, image);
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

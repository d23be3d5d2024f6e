#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/image/module/files.h"

namespace aerosol::image {

namespace {

/// IEC 61966-2-1.
float encodeSrgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

/// The first three channels encoded.
std::vector<float> encoded(const std::vector<float>& values, int channels) {
  std::vector<float> result(values);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (i % static_cast<std::size_t>(channels) < 3) result[i] = encodeSrgb(result[i]);
  }
  return result;
}

OIIO::TypeDesc storedType(PlainOptions::Type type, OIIO::TypeDesc given) {
  switch (type) {
    case PlainOptions::Type::uint8:
      return OIIO::TypeDesc::UINT8;
    case PlainOptions::Type::float16:
      return OIIO::TypeDesc::HALF;
    case PlainOptions::Type::float32:
      return OIIO::TypeDesc::FLOAT;
    case PlainOptions::Type::asIs:
      break;
  }
  return given;
}

std::string write(const std::string& path, const std::string& format, const PlainImage& image, PlainOptions::Type type,
                  OIIO::TypeDesc given, const void* values) {
  const auto output = OIIO::ImageOutput::create(format);
  if (!output) return "cannot write ." + format + " files: " + OIIO::geterror();
  const OIIO::ImageSpec spec(image.width, image.height, image.channels, storedType(type, given));
  if (!output->open(path, spec)) return output->geterror();
  if (!output->write_image(given, values)) return output->geterror();
  if (!output->close()) return output->geterror();
  return {};
}

}  // namespace

std::string writePlainFile(const std::string& path, const std::string& format, const PlainImage& image,
                           const PlainOptions& options) {
  try {
    if (const auto* floats = std::get_if<std::vector<float>>(&image.values)) {
      const std::vector<float> curved = options.encodeSrgb ? encoded(*floats, image.channels) : std::vector<float>{};
      return write(path, format, image, options.type, OIIO::TypeDesc::FLOAT,
                   options.encodeSrgb ? curved.data() : floats->data());
    }
    return write(path, format, image, options.type, OIIO::TypeDesc::INT32,
                 std::get<std::vector<std::int32_t>>(image.values).data());
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace aerosol::image

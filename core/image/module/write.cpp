#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>

#include "core/image/module/display.h"
#include "core/image/module/files.h"

namespace aerosol::image {

namespace {

constexpr std::string_view compressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                             "pxr24", "b44", "b44a", "dwaa", "dwab"};

std::string textOf(const Metadata& entry) {
  if (const auto* text = std::get_if<std::string>(&entry.value)) return *text;
  if (const auto* integer = std::get_if<std::int32_t>(&entry.value)) return std::to_string(*integer);
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.17g", std::get<double>(entry.value));
  return digits;
}

void setMetadata(OIIO::ImageSpec& spec, const std::vector<Metadata>& metadata) {
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

/// PNG and JPEG keep text only.
void setTextMetadata(OIIO::ImageSpec& spec, const std::vector<Metadata>& metadata) {
  for (const Metadata& entry : metadata) spec.attribute(entry.key, textOf(entry));
}

std::string store(const std::string& path, const char* format, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                  const void* pixels) {
  const auto output = OIIO::ImageOutput::create(format);
  if (!output) return "OpenImageIO cannot write this format: " + OIIO::geterror();
  if (!output->open(path, spec)) return output->geterror();
  if (!output->write_image(type, pixels)) return output->geterror();
  if (!output->close()) return output->geterror();
  return {};
}

std::string writeExr(const std::string& path, const ImageBuffer& image, const WriteOptions& options) {
  if (std::ranges::find(compressions, options.compression) == std::end(compressions)) {
    return "'" + options.compression +
           "' is not a compression of EXR; known are: none rle zips zip piz pxr24 b44 b44a dwaa dwab";
  }
  const bool isHalf = options.pixelType == PixelType::float16;
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()),
                       isHalf ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
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
  spec.attribute("compression", options.compression);
  setMetadata(spec, image.metadata);
  if (!isHalf) return store(path, "openexr", spec, OIIO::TypeDesc::FLOAT, image.pixels.data());
  constexpr float largestHalf = 65504;
  std::vector<float> saturated(image.pixels);
  for (float& value : saturated) {
    if (std::isfinite(value)) value = std::clamp(value, -largestHalf, largestHalf);
  }
  return store(path, "openexr", spec, OIIO::TypeDesc::FLOAT, saturated.data());
}

/// [0, 1] to the whole range of `Integer`, rounded to nearest.
template <class Integer>
std::vector<Integer> quantize(const std::vector<float>& values) {
  constexpr double scale = std::numeric_limits<Integer>::max();
  std::vector<Integer> integers(values.size());
  std::ranges::transform(values, integers.begin(), [](float value) {
    const double clamped = std::isnan(value) ? 0 : std::clamp(static_cast<double>(value), 0.0, 1.0);
    return static_cast<Integer>(std::floor(clamped * scale + 0.5));
  });
  return integers;
}

std::string writeForDisplay(const std::string& path, const std::string& format, const ImageBuffer& image,
                            const WriteOptions& options, WriteReport& report) {
  const bool isPng = format == "png";
  DisplayPicture picture;
  std::string message = toDisplay(image, options.display, isPng, picture, report);
  if (!message.empty()) return message;
  const bool is16 = options.pixelType == PixelType::uint16;
  OIIO::ImageSpec spec(image.width, image.height, picture.channels,
                       is16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
  if (picture.isSrgb) spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", options.jpegQuality);
  setTextMetadata(spec, image.metadata);
  const char* plugin = isPng ? "png" : "jpeg";
  if (is16) {
    return store(path, plugin, spec, OIIO::TypeDesc::UINT16, quantize<std::uint16_t>(picture.pixels).data());
  }
  return store(path, plugin, spec, OIIO::TypeDesc::UINT8, quantize<std::uint8_t>(picture.pixels).data());
}

}  // namespace

std::string writeFile(const std::string& path, const std::string& format, const ImageBuffer& image,
                      const WriteOptions& options, WriteReport& report) {
  try {
    if (format == "exr") return writeExr(path, image, options);
    return writeForDisplay(path, format, image, options, report);
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace aerosol::image

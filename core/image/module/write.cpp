#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <optional>

#include "core/image/module/display.h"
#include "core/image/module/files.h"
#include "core/image/module/specs.h"

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

/// Bytes as a part of an EXR: their number in the first two texels, then four a texel.
struct AttachmentPart {
  OIIO::ImageSpec spec;
  std::vector<std::uint32_t> words;

  AttachmentPart(const std::string& bytes, const OIIO::ImageSpec& picture, const std::string& compression) {
    const std::size_t count = 2 + (bytes.size() + 3) / 4;
    const std::size_t width = std::min<std::size_t>(count, attachmentWidth);
    const std::size_t height = (count + width - 1) / width;
    words.resize(width * height);
    words[0] = static_cast<std::uint32_t>(bytes.size());
    words[1] = static_cast<std::uint32_t>(bytes.size() >> 32);
    std::memcpy(words.data() + 2, bytes.data(), bytes.size());
    spec = OIIO::ImageSpec(static_cast<int>(width), static_cast<int>(height), 1, OIIO::TypeDesc::UINT32);
    spec.channelnames = {"words"};
    // All parts of a file have one display window.
    spec.full_x = picture.full_x;
    spec.full_y = picture.full_y;
    spec.full_width = picture.full_width;
    spec.full_height = picture.full_height;
    spec.attribute("compression", compression);
    spec.attribute("oiio:subimagename", attachmentName);
  }
};

constexpr float largestHalf = 65504;

/// Pixels as a part of an EXR.
struct PicturePart {
  OIIO::ImageSpec spec;
  const std::vector<float>& pixels;

  /// What half floats cannot hold becomes the largest that they can.
  std::vector<float> saturated() const {
    std::vector<float> values(pixels);
    for (float& value : values) {
      if (std::isfinite(value)) value = std::clamp(value, -largestHalf, largestHalf);
    }
    return values;
  }
  bool write(OIIO::ImageOutput& output) const {
    const bool isHalf = spec.format == OIIO::TypeDesc::HALF;
    return output.write_image(OIIO::TypeDesc::FLOAT, isHalf ? saturated().data() : pixels.data());
  }
};

std::string storeParts(const std::string& path, const std::vector<PicturePart>& pictures,
                       const std::optional<AttachmentPart>& attachment) {
  const auto output = OIIO::ImageOutput::create("openexr");
  if (!output) return "OpenImageIO cannot write this format: " + OIIO::geterror();
  std::vector<OIIO::ImageSpec> specs;
  for (const PicturePart& part : pictures) specs.push_back(part.spec);
  if (attachment) specs.push_back(attachment->spec);
  const bool isOpen = specs.size() == 1 ? output->open(path, specs[0])
                                        : output->open(path, static_cast<int>(specs.size()), specs.data());
  if (!isOpen) return output->geterror();
  for (std::size_t i = 0; i < specs.size(); ++i) {
    if (i > 0 && !output->open(path, specs[i], OIIO::ImageOutput::AppendSubimage)) return output->geterror();
    const bool isWritten = i < pictures.size() ? pictures[i].write(*output)
                                               : output->write_image(OIIO::TypeDesc::UINT32, attachment->words.data());
    if (!isWritten) return output->geterror();
  }
  return output->close() ? std::string() : output->geterror();
}

std::string writeExr(const std::string& path, const ImageBuffer& image, const WriteOptions& options) {
  if (std::ranges::find(compressions, options.compression) == std::end(compressions)) {
    return "'" + options.compression +
           "' is not a compression of EXR; known are: none rle zips zip piz pxr24 b44 b44a dwaa dwab";
  }
  const bool isHalf = options.pixelType == PixelType::float16;
  OIIO::ImageSpec spec = specOf(image, isHalf ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
  spec.attribute("compression", options.compression);
  const OIIO::ImageSpec plain = spec;
  setMetadata(spec, image.metadata);
  std::vector<PicturePart> parts = {{spec, image.pixels}};
  for (const ImageLayer& layer : image.layers) {
    PicturePart& part = parts.emplace_back(plain, layer.pixels);
    part.spec.nchannels = static_cast<int>(layer.channels.size());
    part.spec.channelnames = layer.channels;
    part.spec.set_format(isHalf && !layer.isData ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
    part.spec.attribute("oiio:subimagename", layer.name);
    setMetadata(part.spec, layer.metadata);
  }
  std::optional<AttachmentPart> attachment;
  if (!image.attachment.empty()) attachment.emplace(image.attachment, plain, options.compression);
  if (parts.size() > 1 || attachment) parts[0].spec.attribute("oiio:subimagename", "picture");
  return storeParts(path, parts, attachment);
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

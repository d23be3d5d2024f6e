#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>

#include <exception>

#include "core/image/module/files.h"
#include "core/image/module/specs.h"

namespace aerosol::image {

namespace {

std::string write(const std::string& path, const DeepImage& image) {
  const auto output = OIIO::ImageOutput::create("openexr");
  if (!output) return "OpenImageIO cannot write this format: " + OIIO::geterror();
  OIIO::ImageSpec spec = specOf(image, OIIO::TypeDesc::FLOAT);
  spec.deep = true;
  spec.attribute("compression", "zips");
  setMetadata(spec, image.metadata);
  OIIO::DeepData data(spec);
  std::size_t value = 0;
  for (std::size_t pixel = 0; pixel < image.counts.size(); ++pixel) {
    const auto at = static_cast<std::int64_t>(pixel);
    data.set_samples(at, static_cast<int>(image.counts[pixel]));
    for (int sample = 0; sample < static_cast<int>(image.counts[pixel]); ++sample) {
      for (int channel = 0; channel < spec.nchannels; ++channel)
        data.set_deep_value(at, channel, sample, image.values[value++]);
    }
  }
  if (!output->open(path, spec)) return output->geterror();
  if (!output->write_deep_image(data)) return output->geterror();
  return output->close() ? std::string() : output->geterror();
}

std::string read(const std::string& path, DeepImage& image) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) return OIIO::geterror();
  const OIIO::ImageSpec spec = input->spec();
  if (!spec.deep) return "this image is not deep";
  OIIO::DeepData data;
  if (!input->read_native_deep_image(0, 0, data)) return input->geterror();
  image.width = spec.width;
  image.height = spec.height;
  image.originX = spec.x;
  image.originY = spec.y;
  image.fullWidth = spec.full_width;
  image.fullHeight = spec.full_height;
  image.channels = spec.channelnames;
  const auto pixels = static_cast<std::int64_t>(spec.width) * spec.height;
  for (std::int64_t pixel = 0; pixel < pixels; ++pixel) {
    const int samples = data.samples(pixel);
    image.counts.push_back(static_cast<std::uint32_t>(samples));
    for (int sample = 0; sample < samples; ++sample) {
      for (int channel = 0; channel < spec.nchannels; ++channel)
        image.values.push_back(data.deep_value(pixel, channel, sample));
    }
  }
  return {};
}

}  // namespace

std::string writeDeepFile(const std::string& path, const DeepImage& image) {
  try {
    return write(path, image);
  } catch (const std::exception& error) {
    return error.what();
  }
}

std::string readDeepFile(const std::string& path, DeepImage& image) {
  try {
    return read(path, image);
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace aerosol::image

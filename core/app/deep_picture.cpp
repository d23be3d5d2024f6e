#include "core/app/deep_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/render/aov/deep_pixels.h"

namespace aerosol::app {

namespace {

bool isChromatic(const Color& opacity) {
  constexpr float least = 1e-6f;
  return std::fabs(opacity.r - opacity.g) > least || std::fabs(opacity.g - opacity.b) > least;
}

}  // namespace

image::DeepImage makeDeepPicture(const render::Film& film, const scene::Film& described, double error) {
  const render::PixelRect area = film.area();
  image::DeepImage image{.width = area.width(),
                         .height = area.height(),
                         .originX = area.x0,
                         .originY = area.y0,
                         .fullWidth = described.width,
                         .fullHeight = described.height,
                         .channels = {"R", "G", "B", "A", "Z", "ZBack"},
                         .counts = {},
                         .values = {},
                         .metadata = {}};
  std::vector<render::DeepSample> samples;
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const std::vector<double> sums = film.aovs(x, y).total().values;
      const auto pixel = render::deepSamples(film.layout().deep, sums, film.pixel(x, y).count(), error);
      image.counts.push_back(static_cast<std::uint32_t>(pixel.size()));
      samples.insert(samples.end(), pixel.begin(), pixel.end());
    }
  }
  const bool hasColors = std::any_of(samples.begin(), samples.end(),
                                     [](const render::DeepSample& sample) { return isChromatic(sample.opacity); });
  if (hasColors) image.channels.insert(image.channels.end(), {"AR", "AG", "AB"});
  image.values.reserve(samples.size() * image.channels.size());
  for (const render::DeepSample& s : samples) {
    const float alpha = hasColors ? average(s.opacity) : s.opacity.r;
    for (const float value : {s.light.r, s.light.g, s.light.b, alpha, s.front, s.back}) image.values.push_back(value);
    if (!hasColors) continue;
    for (int c = 0; c < 3; ++c) image.values.push_back(s.opacity[c]);
  }
  return image;
}

Diagnostics writeDeepPicture(const DeepArguments& deep, const render::Film& film, const scene::Film& described,
                             std::vector<image::Metadata> metadata, std::string& note) {
  image::DeepImage image = makeDeepPicture(film, described, deep.error);
  image.metadata = std::move(metadata);
  note = fmt::format("wrote {}: {:.1f} samples a pixel along depth\n", deep.file,
                     static_cast<double>(image.values.size() / image.channels.size()) /
                         static_cast<double>(std::max<std::size_t>(image.counts.size(), 1)));
  return image::writeDeepImage(deep.file, image);
}

}  // namespace aerosol::app

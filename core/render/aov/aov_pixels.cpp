#include "core/render/aov/aov_pixels.h"

#include <algorithm>

namespace aerosol::render {

namespace {

/// What becomes of the sums of one pixel with at least one sample.
void appendGathered(const AovLayer& layer, const std::vector<double>& sums, double count, std::vector<float>& pixels) {
  for (std::size_t c = 0; c < layer.channels.size(); ++c) {
    const double sum = sums[layer.first + c];
    if (layer.finish == AovFinish::mean) {
      pixels.push_back(static_cast<float>(sum / count));
    } else if (layer.finish == AovFinish::share) {
      const double weight = sums[layer.second];
      pixels.push_back(weight != 0 ? static_cast<float>(sum / weight) : 0.0f);
    } else {
      const double scatter = std::max(0.0, sums[layer.second + c] - sum * sum / count);
      pixels.push_back(count > 1 ? static_cast<float>(scatter / (count * (count - 1))) : 0.0f);
    }
  }
}

void appendPixel(const Film& film, const AovLayer& layer, int x, int y, std::vector<float>& pixels) {
  const PixelEstimate pixel = film.estimate(x, y);
  const Color error = pixel.standardError;
  switch (layer.finish) {
    case AovFinish::picture:
      pixels.insert(pixels.end(), {pixel.color.r, pixel.color.g, pixel.color.b});
      if (layer.channels.size() > 3) pixels.push_back(pixel.alpha);
      return;
    case AovFinish::standardError:
      pixels.insert(pixels.end(), {error.r, error.g, error.b});
      return;
    case AovFinish::pictureVariance:
      pixels.insert(pixels.end(), {error.r * error.r, error.g * error.g, error.b * error.b});
      return;
    case AovFinish::sampleCount:
      pixels.push_back(static_cast<float>(pixel.count));
      return;
    default:
      break;
  }
  const AovSums sums = film.aovs(x, y).total();
  if (pixel.count == 0 || sums.values.empty()) {
    pixels.insert(pixels.end(), layer.channels.size(), 0.0f);
  } else {
    appendGathered(layer, sums.values, pixel.count, pixels);
  }
}

}  // namespace

std::vector<float> layerPixels(const Film& film, const AovLayer& layer) {
  std::vector<float> pixels;
  pixels.reserve(film.area().pixelCount() * layer.channels.size());
  for (int y = film.area().y0; y < film.area().y1; ++y) {
    for (int x = film.area().x0; x < film.area().x1; ++x) appendPixel(film, layer, x, y, pixels);
  }
  return pixels;
}

}  // namespace aerosol::render

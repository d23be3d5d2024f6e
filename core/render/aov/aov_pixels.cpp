#include "core/render/aov/aov_pixels.h"

#include <algorithm>
#include <bit>

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

/// The pairs of a layer: ids by falling coverage, of equal ones the smaller id first. Noise of what is seen through
/// media may make a sum larger than one, or single shares negative.
void appendRanks(const AovLayer& layer, const AovSums& sums, double count, std::vector<float>& pixels) {
  MatteShares ranked;
  double total = 0;
  if (layer.second < sums.mattes.size()) {
    for (const MatteShare& share : sums.mattes[layer.second]) {
      if (!(share.weight > 0)) continue;
      ranked.push_back({share.id, share.weight / count});
      total += share.weight / count;
    }
  }
  std::sort(ranked.begin(), ranked.end(), [](const MatteShare& a, const MatteShare& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.id < b.id;
  });
  for (std::size_t rank = layer.first; rank < layer.first + 2; ++rank) {
    const bool isThere = rank < ranked.size();
    pixels.push_back(isThere ? std::bit_cast<float>(ranked[rank].id) : 0.0f);
    pixels.push_back(isThere ? static_cast<float>(ranked[rank].weight / std::max(1.0, total)) : 0.0f);
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
  if (layer.finish == AovFinish::matte) {
    appendRanks(layer, sums, pixel.count, pixels);
    return;
  }
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

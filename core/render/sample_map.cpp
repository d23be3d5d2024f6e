#include "core/render/sample_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aerosol::render {

namespace {

constexpr double leastWeight = 0.25, largestWeight = 8;
constexpr double shareOfAll = 1.0 / 16, shareOfNeighbours = 0.25;

int columns(const PixelRect& area) { return (area.width() + SampleMap::tileSize - 1) / SampleMap::tileSize; }

/// Of single samples, the mean over pixels and channels.
double varianceIn(const Film& film, const PixelRect& tile) {
  double sum = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const PixelSum& pixel = film.pixel(x, y);
      const double n = pixel.count();
      if (n < 2) continue;
      const SampleSums total = pixel.total();
      for (std::size_t c = 0; c < 3; ++c) {
        sum += std::max(0.0, total.squares[c] - total.color[c] * total.color[c] / n) / (n - 1);
      }
    }
  }
  return sum / (3 * static_cast<double>(tile.pixelCount()));
}

/// Each tile's value with the mean of the up to eight around it.
std::vector<double> smoothed(const std::vector<double>& values, int width) {
  const int height = static_cast<int>(values.size()) / width;
  std::vector<double> result(values.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      int count = 0;
      for (int v = std::max(y - 1, 0); v < std::min(y + 2, height); ++v) {
        for (int u = std::max(x - 1, 0); u < std::min(x + 2, width); ++u) {
          if (u == x && v == y) continue;
          sum += values[static_cast<std::size_t>(v * width + u)];
          ++count;
        }
      }
      const double own = values[static_cast<std::size_t>(y * width + x)];
      const double around = count > 0 ? sum / count : own;
      result[static_cast<std::size_t>(y * width + x)] = own + shareOfNeighbours * (around - own);
    }
  }
  return result;
}

}  // namespace

SampleMap::SampleMap(const PixelRect& area, std::vector<std::uint32_t> weights)
    : area_(area), weights_(std::move(weights)) {}

std::vector<PixelRect> SampleMap::tilesOf(const PixelRect& area) {
  std::vector<PixelRect> tiles;
  for (int y = area.y0; y < area.y1; y += tileSize) {
    for (int x = area.x0; x < area.x1; x += tileSize) {
      tiles.push_back({x, y, std::min(x + tileSize, area.x1), std::min(y + tileSize, area.y1)});
    }
  }
  return tiles;
}

std::size_t SampleMap::tileOf(int x, int y) const {
  const int column = (x - area_.x0) / tileSize, row = (y - area_.y0) / tileSize;
  return static_cast<std::size_t>(row * columns(area_) + column);
}

std::uint64_t SampleMap::total(std::uint32_t samples) const {
  const std::vector<PixelRect> tiles = tilesOf(area_);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) sum += std::uint64_t{countOf(i, samples)} * tiles[i].pixelCount();
  return sum;
}

std::uint32_t pilotSamples(std::uint32_t samples) { return std::clamp(samples / 8, 4u, 16u); }

SampleMap mapFromPilot(const Film& pilot) {
  const std::vector<PixelRect> tiles = SampleMap::tilesOf(pilot.area());
  std::vector<double> variances;
  for (const PixelRect& tile : tiles) variances.push_back(varianceIn(pilot, tile));
  variances = smoothed(variances, columns(pilot.area()));
  double all = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) all += variances[i] * static_cast<double>(tiles[i].pixelCount());
  all /= static_cast<double>(pilot.area().pixelCount());

  std::vector<double> deviations;
  double mean = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    deviations.push_back(std::sqrt(variances[i] + shareOfAll * all));
    mean += deviations[i] * static_cast<double>(tiles[i].pixelCount());
  }
  mean /= static_cast<double>(pilot.area().pixelCount());
  std::vector<std::uint32_t> weights;
  for (const double deviation : deviations) {
    const double weight = mean > 0 ? std::clamp(deviation / mean, leastWeight, largestWeight) : 1;
    weights.push_back(static_cast<std::uint32_t>(std::lround(weight * SampleMap::unit)));
  }
  return {pilot.area(), std::move(weights)};
}

}  // namespace aerosol::render

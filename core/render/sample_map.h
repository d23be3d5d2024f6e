// Adaptive sampling: more samples for the tiles of a film that need them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/render/film.h"

namespace aerosol::render {

/// How many samples the tiles of a film take when a common number is asked for. Tiles are squares from the upper left
/// corner of the film's area, row by row.
class SampleMap {
 public:
  static constexpr int tileSize = 16;
  static constexpr std::uint32_t unit = 8;  ///< Weight of a tile that takes the common number itself.

  /// One weight a tile, each at least 1.
  SampleMap(const PixelRect& area, std::vector<std::uint32_t> weights);

  std::size_t tileCount() const { return weights_.size(); }
  /// What tile `tile` takes for `samples`: samples · weight / unit, rounded up.
  std::uint32_t countOf(std::size_t tile, std::uint32_t samples) const {
    return static_cast<std::uint32_t>((std::uint64_t{samples} * weights_[tile] + unit - 1) / unit);
  }
  std::uint32_t countAt(int x, int y, std::uint32_t samples) const { return countOf(tileOf(x, y), samples); }
  /// Of all pixels of the film.
  std::uint64_t total(std::uint32_t samples) const;
  const std::vector<std::uint32_t>& weights() const { return weights_; }

  /// The tiles of an area, row by row.
  static std::vector<PixelRect> tilesOf(const PixelRect& area);

 private:
  std::size_t tileOf(int x, int y) const;

  PixelRect area_;
  std::vector<std::uint32_t> weights_;
};

/// Samples of a pixel that the map is made from, for an image of that many.
std::uint32_t pilotSamples(std::uint32_t samples);

/// The map for which the mean square error of an image is least at a given number of samples altogether: in proportion
/// to the standard deviation of the samples in a tile (Neyman 1934), which `pilot` tells, a film of the same area with
/// other samples of the same scene. As its samples do not enter the image, that has no bias. What the pilot may have
/// missed is allowed for: a tile's variance is mixed with that of its neighbours and of the whole, and weights lie
/// between a quarter and eight.
SampleMap mapFromPilot(const Film& pilot);

}  // namespace aerosol::render

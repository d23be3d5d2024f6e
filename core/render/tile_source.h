// The work of a render: tiles of pixels, pass after pass.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/render/film.h"
#include "core/render/sample_map.h"

namespace aerosol::render {

/// Some samples of the pixels of one tile.
struct TileWork {
  std::size_t tile = 0;  ///< Index of the tile, the same in every pass.
  PixelRect area;
  std::uint32_t firstSample = 0;
  std::uint32_t endSample = 0;
};

/// Hands out work to any thread. Passes double in size up to a whole block of 64 samples, so that there is a picture
/// early and little is lost at an interruption; they never cross a block's end. Samples that the film has already are
/// left out: a render is carried on with what is missing.
class TileSource {
 public:
  static constexpr int tileSize = SampleMap::tileSize;

  /// Looks at the film in the constructor alone. With a `map` of the film's area, which outlives this, its tiles take
  /// the samples between what it says for `firstSample` and for `endSample`.
  TileSource(const Film& film, std::uint32_t firstSample, std::uint32_t endSample, const SampleMap* map = nullptr);

  std::optional<TileWork> next();
  const std::vector<PixelRect>& tiles() const { return tiles_; }
  /// Samples of all pixels that were there already.
  std::uint64_t presentSamples() const { return presentSamples_; }
  /// Samples of all pixels, with those.
  std::uint64_t totalSamples() const { return totalSamples_; }

 private:
  struct Pass {
    std::uint32_t first = 0, end = 0;
  };

  /// What a part of a tile takes of a common number of samples.
  std::uint32_t countIn(const PixelRect& part, std::uint32_t samples) const {
    return map_ ? map_->countAt(part.x0, part.y0, samples) : samples;
  }
  void findPresent(const Film& film);
  /// Appends what is missing of a pass over a tile to the queue, last part first.
  void queueMissing(std::size_t tile, const Pass& pass);

  std::uint32_t firstSample_, endSample_;
  std::vector<PixelRect> tiles_;
  std::vector<std::vector<PixelSum::Range>> present_;  ///< By tile: samples that are there; empty when the film is.
  std::vector<Pass> passes_;
  std::uint64_t presentSamples_ = 0, totalSamples_ = 0;
  const SampleMap* map_;
  std::mutex mutex_;
  std::size_t next_ = 0;  ///< Pass · tiles + tile.
  std::vector<TileWork> queue_;
};

}  // namespace aerosol::render

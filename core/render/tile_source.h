// The work of a render: tiles of pixels, pass after pass.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/render/film.h"

namespace aerosol::render {

/// Some samples of the pixels of one tile.
struct TileWork {
  std::size_t tile = 0;  ///< Index of the tile, the same in every pass.
  PixelRect area;
  std::uint32_t firstSample = 0;
  std::uint32_t endSample = 0;
};

/// Hands out work to any thread. Passes double in size up to a whole block of 64 samples, so that there is a picture
/// early and little is lost at an interruption; they never cross a block's end.
class TileSource {
 public:
  static constexpr int tileSize = 16;

  TileSource(const PixelRect& area, std::uint32_t firstSample, std::uint32_t endSample);

  std::optional<TileWork> next();
  std::size_t tileCount() const { return tiles_.size(); }

 private:
  struct Pass {
    std::uint32_t first = 0, end = 0;
  };
  std::vector<PixelRect> tiles_;
  std::vector<Pass> passes_;
  std::atomic<std::size_t> next_{0};
};

}  // namespace aerosol::render

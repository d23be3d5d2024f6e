#include "core/render/tile_source.h"

#include <algorithm>

namespace aerosol::render {

TileSource::TileSource(const PixelRect& area, std::uint32_t firstSample, std::uint32_t endSample) {
  for (int y = area.y0; y < area.y1; y += tileSize) {
    for (int x = area.x0; x < area.x1; x += tileSize) {
      tiles_.push_back({x, y, std::min(x + tileSize, area.x1), std::min(y + tileSize, area.y1)});
    }
  }
  std::uint32_t size = 1;
  for (std::uint32_t first = firstSample; first < endSample;) {
    const std::uint32_t blockEnd = (first / PixelSum::blockSize + 1) * PixelSum::blockSize;
    const std::uint32_t end = std::min({first + size, blockEnd, endSample});
    passes_.push_back({first, end});
    first = end;
    size = std::min(2 * size, PixelSum::blockSize);
  }
}

std::optional<TileWork> TileSource::next() {
  const std::size_t i = next_.fetch_add(1, std::memory_order_relaxed);
  if (tiles_.empty() || i / tiles_.size() >= passes_.size()) return {};
  const Pass& pass = passes_[i / tiles_.size()];
  return TileWork{i % tiles_.size(), tiles_[i % tiles_.size()], pass.first, pass.end};
}

}  // namespace aerosol::render

#include "core/render/tile_source.h"

#include <algorithm>

namespace aerosol::render {

TileSource::TileSource(const Film& film, std::uint32_t firstSample, std::uint32_t endSample, const SampleMap* map)
    : firstSample_(firstSample), endSample_(endSample), tiles_(SampleMap::tilesOf(film.area())), map_(map) {
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    const std::uint64_t samples = countIn(tiles_[i], endSample_) - countIn(tiles_[i], firstSample_);
    totalSamples_ += samples * tiles_[i].pixelCount();
  }
  findPresent(film);
  std::uint32_t size = 1;
  for (std::uint32_t first = firstSample; first < endSample;) {
    const std::uint32_t blockEnd = (first / PixelSum::blockSize + 1) * PixelSum::blockSize;
    const std::uint32_t end = std::min({first + size, blockEnd, endSample});
    passes_.push_back({first, end});
    first = end;
    size = std::min(2 * size, PixelSum::blockSize);
  }
}

/// Work is done tile by tile, so the pixels of one have the same samples. Where they have not, because films of other
/// crops were joined, the tile is cut into its pixels.
void TileSource::findPresent(const Film& film) {
  if (film.sampleCount() + film.droppedCount() == 0) return;
  std::vector<PixelRect> parts;
  const auto add = [&](const PixelRect& part) {
    present_.push_back(film.pixel(part.x0, part.y0).ranges());
    for (const PixelSum::Range& range : present_.back()) {
      const std::uint64_t first = std::max<std::uint64_t>(range.first, countIn(part, firstSample_));
      const std::uint64_t end = std::min<std::uint64_t>(range.end, countIn(part, endSample_));
      if (first < end) presentSamples_ += (end - first) * part.pixelCount();
    }
    parts.push_back(part);
  };
  for (const PixelRect& tile : tiles_) {
    const auto ranges = film.pixel(tile.x0, tile.y0).ranges();
    bool isUniform = true;
    for (int y = tile.y0; y < tile.y1 && isUniform; ++y) {
      for (int x = tile.x0; x < tile.x1 && isUniform; ++x) isUniform = film.pixel(x, y).ranges() == ranges;
    }
    if (isUniform) {
      add(tile);
      continue;
    }
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) add({x, y, x + 1, y + 1});
    }
  }
  tiles_ = std::move(parts);
}

void TileSource::queueMissing(std::size_t tile, const Pass& pass) {
  // The last block first. A tile that takes more samples than others may reach over the ends of blocks in one pass.
  const auto add = [&](std::uint64_t first, std::uint64_t end) {
    while (first < end) {
      const std::uint64_t begin = std::max(first, (end - 1) / PixelSum::blockSize * PixelSum::blockSize);
      queue_.push_back({tile, tiles_[tile], static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
      end = begin;
    }
  };
  const std::uint64_t passFirst = countIn(tiles_[tile], pass.first);
  std::uint64_t end = countIn(tiles_[tile], pass.end);
  if (!present_.empty()) {
    for (auto range = present_[tile].rbegin(); range != present_[tile].rend(); ++range) {
      if (range->first >= end) continue;
      add(std::max<std::uint64_t>(passFirst, range->end), end);
      end = range->first;
      if (end <= passFirst) return;
    }
  }
  add(passFirst, end);
}

std::optional<TileWork> TileSource::next() {
  const std::scoped_lock lock(mutex_);
  while (queue_.empty()) {
    if (tiles_.empty() || next_ / tiles_.size() >= passes_.size()) return {};
    queueMissing(next_ % tiles_.size(), passes_[next_ / tiles_.size()]);
    ++next_;
  }
  const TileWork work = queue_.back();
  queue_.pop_back();
  return work;
}

}  // namespace aerosol::render

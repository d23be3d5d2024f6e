#include "core/render/tile_source.h"

#include <gtest/gtest.h>

#include <map>

namespace aerosol::render {
namespace {

constexpr PixelRect area{5, 7, 45, 40};

void addSamples(Film& film, const PixelRect& part, std::uint32_t first, std::uint32_t end) {
  FilmTile tile(part, first, end);
  for (int y = part.y0; y < part.y1; ++y) {
    for (int x = part.x0; x < part.x1; ++x) {
      for (std::uint32_t i = first; i < end; ++i) tile.add(x, y, i, Color(1.0f), 1);
    }
  }
  film.commit(tile);
}

/// Does all the work; afterwards every pixel has to have exactly the samples first ≤ i < end, or what a map says
/// instead: none twice, none missing.
void finish(Film& film, std::uint32_t first, std::uint32_t end, const SampleMap* map = nullptr) {
  TileSource source(film, first, end, map);
  std::uint64_t done = 0;
  while (const auto work = source.next()) {
    ASSERT_LT(work->firstSample, work->endSample);
    ASSERT_EQ(work->firstSample / PixelSum::blockSize, (work->endSample - 1) / PixelSum::blockSize);
    for (int y = work->area.y0; y < work->area.y1; ++y) {
      for (int x = work->area.x0; x < work->area.x1; ++x) {
        for (const auto& range : film.pixel(x, y).ranges()) {
          ASSERT_TRUE(range.end <= work->firstSample || work->endSample <= range.first) << "again";
        }
      }
    }
    addSamples(film, work->area, work->firstSample, work->endSample);
    done += (work->endSample - work->firstSample) * work->area.pixelCount();
  }
  const std::uint64_t all = map ? map->total(end) - map->total(first) : std::uint64_t{end - first} * area.pixelCount();
  EXPECT_EQ(source.totalSamples(), all);
  EXPECT_EQ(done + source.presentSamples(), all);
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const PixelSum::Range range{map ? map->countAt(x, y, first) : first, map ? map->countAt(x, y, end) : end};
      ASSERT_EQ(film.pixel(x, y).ranges(), std::vector{range}) << x << ' ' << y;
    }
  }
}

TEST(TileSource, CoversAnEmptyFilm) {
  for (const auto& [first, end] : {std::pair{0u, 1u}, {0u, 200u}, {7u, 100u}, {63u, 65u}}) {
    Film film(area);
    finish(film, first, end);
  }
}

/// Tiles of the area are 3 × 3, those at its right and lower edge smaller.
TEST(TileSource, GivesTilesWhatAMapSays) {
  const SampleMap map(area, {8, 2, 64, 3, 8, 9, 20, 8, 1});
  for (const std::uint32_t end : {1u, 7u, 64u, 100u}) {
    Film film(area);
    finish(film, 0, end, &map);
  }
  Film film(area);
  finish(film, 0, 12, &map);
  finish(film, 0, 40, &map);
}

TEST(TileSource, LeavesOutWhatIsThere) {
  Film film(area);
  addSamples(film, area, 10, 20);
  addSamples(film, area, 40, 70);
  addSamples(film, area, 100, 128);
  finish(film, 0, 200);
}

TEST(TileSource, GoesOnWhereTilesHaveDifferentSamples) {
  Film film(area);
  addSamples(film, {5, 7, 21, 23}, 0, 31);
  addSamples(film, {21, 7, 37, 23}, 0, 63);
  finish(film, 0, 130);
}

/// Films of crops that no tile knows of.
TEST(TileSource, GoesOnWherePixelsOfATileDiffer) {
  Film film(area);
  addSamples(film, {8, 9, 12, 15}, 3, 9);
  addSamples(film, {30, 30, 45, 40}, 0, 64);
  finish(film, 0, 70);
}

TEST(TileSource, HasNothingToDoForAFilmThatIsComplete) {
  Film film(area);
  addSamples(film, area, 0, 50);
  TileSource source(film, 0, 50);
  EXPECT_FALSE(source.next());
  EXPECT_EQ(source.presentSamples(), 50u * area.pixelCount());
}

}  // namespace
}  // namespace aerosol::render

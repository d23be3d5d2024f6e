#include "core/render/film.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "core/base/random.h"

namespace aerosol::render {
namespace {

Color colorAt(int x, int y, std::uint32_t sample) {
  const std::uint64_t key = pixelKey(3, x, y);
  return {randomFloat(key, sample, 0), 1e6f * randomFloat(key, sample, 1), randomFloat(key, sample, 2) - 0.5f};
}

/// Renders samples of a tile in an order that depends on `seed`.
void renderTile(Film& film, const PixelRect& area, std::uint32_t first, std::uint32_t end, std::uint64_t seed) {
  FilmTile tile(area, first, end);
  const auto width = static_cast<std::uint64_t>(area.width());
  const std::uint64_t total = area.pixelCount() * (end - first);
  std::vector<std::uint64_t> order(total);
  for (std::uint64_t i = 0; i < total; ++i) order[i] = i;
  for (std::uint64_t i = total; i-- > 1;) std::swap(order[i], order[mixBits(seed + i) % (i + 1)]);
  for (const std::uint64_t i : order) {
    const std::uint64_t pixel = i / (end - first);
    const auto sample = static_cast<std::uint32_t>(first + i % (end - first));
    const int x = area.x0 + static_cast<int>(pixel % width), y = area.y0 + static_cast<int>(pixel / width);
    tile.add(x, y, sample, colorAt(x, y, sample), 1);
  }
  ASSERT_TRUE(tile.isComplete());
  film.commit(tile);
}

void expectSame(const Film& a, const Film& b) {
  ASSERT_EQ(a.area(), b.area());
  for (int y = a.area().y0; y < a.area().y1; ++y) {
    for (int x = a.area().x0; x < a.area().x1; ++x) {
      ASSERT_EQ(a.pixel(x, y).total(), b.pixel(x, y).total()) << x << ' ' << y;
      ASSERT_EQ(a.pixel(x, y), b.pixel(x, y));
    }
  }
  EXPECT_EQ(a.rgba(), b.rgba());
}

constexpr PixelRect wholeArea{0, 0, 20, 12};

std::unique_ptr<Film> renderWhole(std::uint32_t samples) {
  auto film = std::make_unique<Film>(wholeArea);
  for (std::uint32_t first = 0; first < samples; first += 64) {
    renderTile(*film, wholeArea, first, std::min(samples, first + 64), 1);
  }
  return film;
}

TEST(Film, TilesPassesAndThreadsDoNotChangeABit) {
  const auto reference = renderWhole(100);
  Film film(wholeArea);
  std::vector<std::thread> threads;
  for (int worker = 0; worker < 4; ++worker) {
    threads.emplace_back([&film, worker] {
      for (int tile = worker; tile < 5 * 3; tile += 4) {
        const int x = tile % 5 * 4, y = tile / 5 * 4;
        const PixelRect area{x, y, x + 4, y + 4};
        for (const auto& [first, end] : {std::pair{0u, 10u}, {40u, 100u}, {10u, 40u}}) {
          renderTile(film, area, first, end, static_cast<std::uint64_t>(tile) * 77 + first);
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  expectSame(film, *reference);
}

TEST(Film, SplitsByCropAndBySamplesMerge) {
  const auto reference = renderWhole(256);
  const auto part = [](PixelRect area, std::uint32_t first, std::uint32_t end) {
    auto film = std::make_unique<Film>(area);
    for (std::uint32_t f = first; f < end; f += 64) renderTile(*film, area, f, std::min(end, f + 64), f);
    return film;
  };
  Film merged(wholeArea);
  for (const auto& [first, end] : {std::pair{100u, 256u}, {0u, 7u}, {7u, 100u}}) {
    EXPECT_FALSE(merged.merge(*part({0, 0, 20, 5}, first, end)).hasErrors());
  }
  EXPECT_FALSE(merged.merge(*part({0, 5, 9, 12}, 0, 256)).hasErrors());
  EXPECT_FALSE(merged.merge(*part({9, 5, 20, 12}, 0, 256)).hasErrors());
  expectSame(merged, *reference);
}

TEST(Film, RefusesWhatDoesNotFit) {
  Film film({0, 0, 4, 4});
  renderTile(film, {0, 0, 4, 4}, 0, 8, 1);
  Film common({2, 2, 4, 4}), elsewhere({2, 2, 5, 4});
  renderTile(common, {2, 2, 4, 4}, 7, 9, 1);
  renderTile(elsewhere, {2, 2, 5, 4}, 8, 9, 1);
  EXPECT_NE(format(film.merge(common)).find("samples in common, such as in pixel (2, 2)"), std::string::npos);
  EXPECT_NE(format(film.merge(elsewhere)).find("different pixels"), std::string::npos);
  EXPECT_EQ(film.sampleCount(), 16u * 8);
}

TEST(Film, DroppedSamplesKeepTheirPlaces) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Film film({10, 10, 14, 14});
  for (int y = 13; y >= 10; --y) {
    FilmTile tile({10, y, 14, y + 1}, 0, 16);
    for (int x = 10; x < 14; ++x) {
      for (std::uint32_t i = 0; i < 16; ++i) tile.add(x, y, i, x == 12 && i == 5 ? Color(nan) : Color(1), 1);
    }
    film.commit(tile);
  }
  EXPECT_EQ(film.droppedCount(), 4u);
  ASSERT_EQ(film.firstDropped().size(), 4u);
  EXPECT_EQ(film.firstDropped()[0].y, 10);
  EXPECT_EQ(film.firstDropped()[0].x, 12);
  EXPECT_EQ(film.firstDropped()[0].sample, 5u);
  EXPECT_EQ(film.estimate(12, 11).color, Color(1));
  EXPECT_EQ(film.estimate(12, 11).count, 15u);
  Film other({10, 10, 14, 14});
  EXPECT_FALSE(other.merge(film).hasErrors());
  EXPECT_EQ(other.firstDropped().size(), 4u);
}

TEST(Film, EstimatesMeanAndStandardError) {
  Film film({0, 0, 1, 1});
  FilmTile tile({0, 0, 1, 1}, 0, 4);
  for (std::uint32_t i = 0; i < 4; ++i) tile.add(0, 0, i, Color(static_cast<float>(i), 2, -1), i < 1 ? 1.0f : 0.0f);
  film.commit(tile);
  const PixelEstimate e = film.estimate(0, 0);
  EXPECT_FLOAT_EQ(e.color.r, 1.5f);
  EXPECT_FLOAT_EQ(e.alpha, 0.25f);
  EXPECT_FLOAT_EQ(e.standardError.r, std::sqrt(5.0f / 3 / 4));
  EXPECT_EQ(e.standardError.g, 0);
  EXPECT_EQ(e.color.b, -1);
  EXPECT_EQ(e.count, 4u);
}

TEST(Film, AnUnfinishedTileCountsWhatIsThere) {
  Film film({0, 0, 2, 1});
  FilmTile tile({0, 0, 2, 1}, 0, 8);
  tile.add(0, 0, 0, Color(1), 1);
  tile.add(0, 0, 3, Color(3), 1);
  EXPECT_EQ(tile.missing(), 14u);
  film.commit(tile);
  EXPECT_EQ(film.estimate(0, 0).color, Color(2));
  EXPECT_EQ(film.estimate(1, 0).count, 0u);
  EXPECT_EQ(film.estimate(1, 0).color, Color(0));
}

TEST(Film, BytesPerPixelInTheCommonCase) {
  const auto film = renderWhole(256);
  EXPECT_LE(film->bytes() / wholeArea.pixelCount(), 129u);
}

}  // namespace
}  // namespace aerosol::render

#include "core/render/sample_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace aerosol::render {
namespace {

constexpr PixelRect area{3, 5, 3 + 64, 5 + 32};  // 4 × 2 tiles.

/// The map for samples of mean 1 that deviate by `deviation(x)` to either side.
template <class Deviation>
SampleMap mapFor(Deviation deviation) {
  Film film(area);
  FilmTile tile(area, 0, 16);
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      for (std::uint32_t i = 0; i < 16; ++i) tile.add(x, y, i, Color(1 + (i % 2 ? 1.0f : -1.0f) * deviation(x)), 1);
    }
  }
  film.commit(tile);
  return mapFromPilot(film);
}

TEST(SampleMap, CountsRoundUpAndAddUp) {
  const SampleMap map(area, {8, 4, 2, 1, 8, 16, 64, 9});
  EXPECT_EQ(map.countOf(0, 5), 5u);
  EXPECT_EQ(map.countOf(1, 5), 3u);
  EXPECT_EQ(map.countOf(3, 1), 1u);
  EXPECT_EQ(map.countOf(3, 0), 0u);
  EXPECT_EQ(map.countAt(3 + 63, 5 + 31, 8), 9u);
  EXPECT_EQ(map.countAt(3 + 32, 5 + 15, 8), 2u);
  EXPECT_EQ(map.total(8), 256u * (8 + 4 + 2 + 1 + 8 + 16 + 64 + 9));
}

TEST(SampleMap, EvenNoiseGivesEvenSamples) {
  const SampleMap map = mapFor([](int) { return 0.5f; });
  for (const std::uint32_t weight : map.weights()) EXPECT_EQ(weight, SampleMap::unit);
  const SampleMap none = mapFor([](int) { return 0.0f; });
  for (const std::uint32_t weight : none.weights()) EXPECT_EQ(weight, SampleMap::unit);
}

/// Noise in the left column of tiles alone. Of a variance v there, a tile keeps 3/4 and gets 1/4 of its neighbours'
/// mean (of which one in three is noisy for the left column, two in five for the next one, none for the others);
/// everyone gets a sixteenth of the mean of all.
TEST(SampleMap, SamplesGoInProportionToTheDeviation) {
  const SampleMap map = mapFor([](int x) { return x < 3 + 16 ? 2.0f : 0.0f; });
  const double first = 0.75 + 0.25 / 3, second = 0.25 * 2 / 5, all = (first + second) / 4 / 16;
  const double a = std::sqrt(first + all), b = std::sqrt(second + all), c = std::sqrt(all);
  const double mean = (a + b + 2 * c) / 4;
  const auto weight = [&](double deviation) {
    return static_cast<std::uint32_t>(std::lround(8 * std::max(deviation / mean, 0.25)));
  };
  for (const std::size_t row : {std::size_t{0}, std::size_t{4}}) {
    EXPECT_EQ(map.weights()[row], weight(a));
    EXPECT_EQ(map.weights()[row + 1], weight(b));
    EXPECT_EQ(map.weights()[row + 2], weight(c));
    EXPECT_EQ(map.weights()[row + 3], weight(c));
  }
}

}  // namespace
}  // namespace aerosol::render

#include "core/render/contribution_map.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/random.h"

namespace aerosol::render {
namespace {

/// Paths with one vertex each, over the unit cube, which bring 2 before it and x behind it, for a throughput of a half.
std::vector<PilotPath> somePaths() {
  std::vector<PilotPath> paths;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      for (std::uint32_t s = 0; s < 16; ++s) {
        const auto number = [&](std::uint32_t k) {
          return randomFloat(7, static_cast<std::uint32_t>(y * 32 + x) * 16 + s, k);
        };
        const Point<World> place(number(0), number(1), number(2));
        PilotPath path{x, y, s, 2 + 0.5f * place.x, {{place, 0.5f, 2}}};
        paths.push_back(path);
      }
    }
  }
  return paths;
}

TEST(ContributionMapTest, KnowsWhatComesBehindAPlace) {
  const ContributionMap map(somePaths(), 32, 32, 320, 320);
  ASSERT_FALSE(map.isEmpty());
  for (const float x : {0.2f, 0.5f, 0.8f}) EXPECT_NEAR(map.expected({x, 0.5f, 0.5f}), x, 0.1f);
  // Outside of what was seen: as at the border.
  EXPECT_EQ(map.expected({7, 0.5f, 0.5f}), map.expected({1, 0.5f, 0.5f}));
  EXPECT_EQ(map.expected({std::numeric_limits<float>::quiet_NaN(), 0, 0}), map.expected({0, 0, 0}));
  EXPECT_NEAR(map.pixel(10, 300), 2.25f, 0.03f);
  EXPECT_GT(map.pixel(-5, 1000), 0);
}

TEST(ContributionMapTest, DoesNotDependOnTheOrderOfPaths) {
  std::vector<PilotPath> paths = somePaths();
  const ContributionMap map(paths, 32, 32, 320, 320);
  std::ranges::reverse(paths);
  std::ranges::rotate(paths, paths.begin() + 777);
  const ContributionMap other(paths, 32, 32, 320, 320);
  for (int i = 0; i < 100; ++i) {
    const float t = 0.01f * static_cast<float>(i);
    EXPECT_EQ(map.expected({t, 1 - t, t * t}), other.expected({t, 1 - t, t * t}));
    EXPECT_EQ(map.pixel(3 * i, i), other.pixel(3 * i, i));
  }
}

TEST(ContributionMapTest, SplitsWhatWouldBringMuchMoreThanThePixelShows) {
  const ContributionMap map(somePaths(), 32, 32, 320, 320);
  const Point<World> place(0.9f, 0.5f, 0.5f);
  const float one = map.pixel(100, 100) / map.expected(place);
  EXPECT_EQ(map.branches(place, Color(one), 100, 100), 1);
  EXPECT_EQ(map.branches(place, Color(0.99f * ContributionMap::splitAbove * one), 100, 100), 1);
  EXPECT_EQ(map.branches(place, Color(-3.01f * ContributionMap::splitTo * one), 100, 100), 3);
  EXPECT_EQ(map.branches(place, Color(1e6f * one), 100, 100), ContributionMap::mostBranches);
  EXPECT_EQ(map.branches(place, Color(std::numeric_limits<float>::infinity()), 100, 100),
            ContributionMap::mostBranches);
  EXPECT_EQ(map.branches(place, Color(std::numeric_limits<float>::quiet_NaN()), 100, 100), 1);
}

TEST(ContributionMapTest, SurvivalIsWhatIsBroughtOfWhatIsWanted) {
  const ContributionMap map(somePaths(), 32, 32, 320, 320);
  const Point<World> place(0.9f, 0.5f, 0.5f);
  const float enough = ContributionMap::wanted * map.pixel(100, 100) / map.expected(place);
  EXPECT_EQ(map.survival(place, Color(1.01f * enough), 100, 100), 1);
  EXPECT_NEAR(map.survival(place, Color(0.6f * enough), 100, 100), 0.6f, 1e-3f);
  // A coloured throughput brings its mean; no survivor becomes heavier than the limit.
  const Color red(0.9f * enough, 0, 0);
  EXPECT_NEAR(map.survival(place, red, 100, 100), 0.3f, 1e-3f);
  for (const float x : {0.0f, 0.3f, 1.0f}) {
    for (const float t : {1e-6f, 0.01f, 1.0f, 3.0f, 50.0f}) {
      const float survival = map.survival({x, 0, 0}, Color(t, 0.1f * t, 0), 5, 5);
      EXPECT_GT(survival, 0);
      EXPECT_LE(survival, 1);
      EXPECT_LE(t / survival, std::max(t, ContributionMap::largestThroughput) * 1.0001f);
    }
  }
}

/// What is not finite, and what never scattered, tells nothing.
TEST(ContributionMapTest, NeedsPathsWithVertices) {
  EXPECT_TRUE(ContributionMap({}, 4, 4, 4, 4).isEmpty());
  std::vector<PilotPath> paths = somePaths();
  for (PilotPath& path : paths) path.vertices.clear();
  EXPECT_TRUE(ContributionMap(paths, 32, 32, 320, 320).isEmpty());
  paths = somePaths();
  paths[5].value = std::numeric_limits<float>::infinity();
  paths[6].vertices[0].throughput = 0;
  const ContributionMap map(paths, 32, 32, 320, 320);
  EXPECT_TRUE(std::isfinite(map.expected({0.5f, 0.5f, 0.5f})));
}

}  // namespace
}  // namespace aerosol::render

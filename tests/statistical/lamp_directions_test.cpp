#include "core/render/lamp_directions.h"

#include <gtest/gtest.h>

#include "core/render/registry.h"
#include "plugins/registration.h"
#include "tests/statistical/direction_grid.h"
#include "tests/statistical/statistics.h"

// Directions towards lamps in media: samples follow the density, which integrates to one and is that of the light that
// a ray collects.

namespace aerosol::render {
namespace {

using test::countsAgree;
using test::DirectionGrid;
using test::seedOfTest;
using test::Uniforms;

constexpr double pi = std::numbers::pi;

struct ConeCase {
  const char* name;
  float extent;
};

class Cones : public ::testing::TestWithParam<ConeCase> {};

const Point<World> from(0.3f, -0.2f, 0.5f), lampAt(1.1f, 0.4f, -0.3f);

/// In cells of equal solid angle; finer ones around the lamp, where the density is high.
TEST_P(Cones, SamplesFollowTheDensity) {
  const LampCone cone(LampInMedia{0, lampAt, GetParam().extent}, from);
  const Vector<World> axis = normalize(lampAt - from);
  const auto density = [&](Vector<World> d) { return cone.pdf(d); };
  constexpr int samples = 200000;
  for (const double height : {2.0, 0.05}) {
    const DirectionGrid grid(axis, height, 12, 8);
    std::vector<double> observed(grid.cellCount() + 1), expected = grid.integrateCells(density, 40);
    double total = 0;
    for (double& mass : expected) {
      total += mass;
      mass *= samples;
    }
    // The ring around the axis holds the whole peak of a small lamp: quadrature by midpoints is coarse there.
    const bool isResolved = height < 2 || GetParam().extent > 0.05f;
    if (height == 2.0 && isResolved) EXPECT_NEAR(total, 1, 2e-3);
    expected.push_back(samples * std::max(0.0, 1 - total));
    Uniforms random(seedOfTest(static_cast<std::uint64_t>(height * 100)));
    for (int i = 0; i < samples; ++i) {
      const Vector<World> d = cone.sample(random.next2D());
      ASSERT_NEAR(length(d), 1, 1e-5);
      ASSERT_GT(cone.pdf(d), 0);
      ++observed[grid.cell(d)];
    }
    if (isResolved) EXPECT_TRUE(countsAgree(observed, expected)) << height;
  }
}

/// In closed form: the share of directions within an angle of the lamp.
TEST_P(Cones, HaveTheirShareWithinEachAngle) {
  const LampCone cone(LampInMedia{0, lampAt, GetParam().extent}, from);
  const Vector<World> axis = normalize(lampAt - from);
  const double sine = std::max(1e-4, static_cast<double>(GetParam().extent / length(lampAt - from)));
  const double edge = std::asin(sine);
  const double even = 2 * pi * (1 - std::cos(edge)) * (pi - edge) / sine, outside = pi * std::pow(pi - edge, 2);
  const auto shareWithin = [&](double angle) {
    return (even + outside - pi * std::pow(pi - angle, 2)) / (even + outside);
  };
  constexpr int bins = 20, samples = 100000;
  std::vector<double> observed(bins + 1), expected(bins + 1);
  const auto edgeOf = [&](int bin) { return edge + (pi - edge) * bin / bins; };
  expected[0] = samples * shareWithin(edge);
  for (int i = 0; i < bins; ++i)
    expected[static_cast<std::size_t>(i + 1)] = samples * (shareWithin(edgeOf(i + 1)) - shareWithin(edgeOf(i)));
  Uniforms random(seedOfTest());
  for (int i = 0; i < samples; ++i) {
    const Vector<World> d = cone.sample(random.next2D());
    const double angle = 2 * std::asin(std::min(1.0, 0.5 * static_cast<double>(length(d - axis))));
    const int bin = angle <= edge ? 0 : 1 + std::min(bins - 1, static_cast<int>((angle - edge) / (pi - edge) * bins));
    ++observed[static_cast<std::size_t>(bin)];
  }
  EXPECT_TRUE(countsAgree(observed, expected));
}

INSTANTIATE_TEST_SUITE_P(All, Cones,
                         ::testing::Values(ConeCase{"point", 0}, ConeCase{"lamp", 0.02f}, ConeCase{"globe", 0.7f}),
                         [](const auto& info) { return std::string(info.param.name); });

/// Several lamps: the mixture's density is that of its samples, and lamps get parts by their light.
TEST(LampDirectionsTest, MixturesFollowTheirDensity) {
  Registry registry;
  registerPlugins(registry);
  std::vector<std::unique_ptr<const Light>> lights;
  std::vector<LampInMedia> lamps;
  const std::array places{Point<World>(1, 0, 0), Point<World>(-0.5f, 0.8f, 0.2f), Point<World>(0.1f, -1, 0.4f)};
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const Point<scene::Unplaced> p(places[i].x, places[i].y, places[i].z);
    auto light =
        makeLight(registry, "point", {{"intensity", Color(1.0f + static_cast<float>(i))}, {"position", p}}, nullptr);
    ASSERT_TRUE(light);
    lights.push_back(std::move(*light));
    lamps.push_back({i, places[i], 0.1f});
  }
  const LightSet set(std::move(lights), 2);
  const Point<World> here(0.1f, 0.05f, -0.1f);
  const LampDirections directions(lamps, set, here, 0, 0);
  ASSERT_FALSE(directions.isEmpty());
  EXPECT_NEAR(directions.share(), LampDirections::largestShare, 1e-5);
  EXPECT_TRUE(LampDirections(lamps, set, here, 0, 1).isEmpty()) << "a phase function that is a peak";
  EXPECT_LT(LampDirections(lamps, set, here, 10, 0).share(), 0.6 * LampDirections::largestShare) << "dense media";
  const DirectionGrid grid({0, 0, 1}, 2, 12, 16);
  std::vector<double> observed(grid.cellCount()),
      expected = grid.integrateCells([&](Vector<World> d) { return directions.pdf(d); }, 60);
  constexpr int samples = 100000;
  double total = 0;
  for (double& mass : expected) {
    total += mass;
    mass *= samples;
  }
  EXPECT_NEAR(total, 1, 2e-3);
  for (double& mass : expected) mass /= total;
  Uniforms random(seedOfTest());
  for (int i = 0; i < samples; ++i) ++observed[grid.cell(directions.sample(random.next2D()))];
  EXPECT_TRUE(countsAgree(observed, expected));
}

}  // namespace
}  // namespace aerosol::render

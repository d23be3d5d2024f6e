#include "core/render/clear_sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace aerosol::render {
namespace {

using std::numbers::pi;

/// cd/m² of one unit of luminance.
constexpr double candelas = 683.002 * 106.857;
constexpr double radians = pi / 180;
const Color grey(0.3f);

double luminance(Color c) {
  return 0.2126729 * static_cast<double>(c.r) + 0.7151522 * static_cast<double>(c.g) +
         0.0721750 * static_cast<double>(c.b);
}

void expectNear(Color found, Color expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance * expected[c]) << c;
}

/// The published model, worked out in double precision apart from this program.
TEST(ClearSky, IsThatOfItsPaper) {
  struct Row {
    double turbidity, elevation;
    Color albedo;
    double zenith, cosineToSun;
    Color radiance;
  };
  const Row rows[] = {
      {3, 45, grey, 30, 0.789149131, {0.0342463f, 0.055952f, 0.103744f}},
      {3, 45, {0, 0.5f, 1}, 80, -0.562997099, {0.0733595f, 0.174269f, 0.335132f}},
      {1, 5, grey, 85, 0.996223604, {0.1081f, 0.116898f, 0.0767655f}},
      {10, 90, Color(0), 0, 1, {0.983654f, 1.0035f, 0.851685f}},
      {6.25, 20, Color(1), 60, 0.984807753, {0.491496f, 0.442839f, 0.340737f}},
      {2.5, 70, Color(0.2f), 89.5, 0.008200261, {0.134436f, 0.168671f, 0.183077f}},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.turbidity);
    const ClearSky sky((90 - row.elevation) * radians, row.turbidity, row.albedo);
    expectNear(sky.sky(std::cos(row.zenith * radians), std::acos(row.cosineToSun)), row.radiance, 2e-4f);
  }
}

TEST(ClearSky, IsBrightAtTheSunAndBlueAwayFromIt) {
  const ClearSky sky(pi / 3, 2.5, grey);
  const Color near = sky.sky(std::cos(pi / 3), 0.02), away = sky.sky(std::cos(pi / 6), pi / 2);
  EXPECT_GT(luminance(near), 4 * luminance(away));
  EXPECT_GT(away.b, 1.5f * away.r);
  EXPECT_LT(near.b / near.r, away.b / away.r);
}

TEST(ClearSky, IsBrighterAboveBrightGround) {
  const Color dark = ClearSky(pi / 4, 3, Color(0)).sky(0.5, 1), bright = ClearSky(pi / 4, 3, Color(1)).sky(0.5, 1),
              red = ClearSky(pi / 4, 3, Color(1, 0, 0)).sky(0.5, 1);
  for (int c = 0; c < 3; ++c) EXPECT_GT(bright[c], 1.1f * dark[c]);
  EXPECT_EQ(red.r, bright.r);
  EXPECT_EQ(red.g, dark.g);
  EXPECT_EQ(red.b, dark.b);
}

/// The sun at noon gives about 100 000 lux, that at 5 degrees far less.
TEST(ClearSky, TheSunFadesAndReddensTowardsTheHorizon) {
  const double solidAngle = 2 * pi * (1 - std::cos(ClearSky::aperture / 2 * radians));
  const Color high = ClearSky(0, 2, grey).sun(), low = ClearSky(85 * radians, 2, grey).sun();
  const double lux = luminance(high) * solidAngle * candelas;
  EXPECT_GT(lux, 90000);
  EXPECT_LT(lux, 125000);
  EXPECT_LT(luminance(low), 0.4 * luminance(high));
  EXPECT_GT(low.r / low.g, high.r / high.g);
  EXPECT_LT(low.b / low.g, high.b / high.g);
  EXPECT_LT(luminance(ClearSky(0, 8, grey).sun()), luminance(high));
}

/// The disc keeps its mean, and its limb has the colours of Mitsuba 3's with `complex_sun`.
TEST(ClearSky, TheSunDarkensTowardsItsLimb) {
  Color mean;
  constexpr int rings = 1000;
  for (int i = 0; i < rings; ++i) mean += ClearSky::limbDarkening(std::sqrt((i + 0.5) / rings)) / rings;
  expectNear(mean, Color(1), 1e-3f);
  expectNear(ClearSky::limbDarkening(0), Color(1.2043f, 1.2494f, 1.3214f), 1e-3f);
  EXPECT_LT(ClearSky::limbDarkening(1).b, 0.25f);
}

TEST(ClearSky, IsFiniteAndNeverNegative) {
  for (const double turbidity : {1.0, 1.7, 2.0, 3.0, 6.0, 10.0}) {
    for (int z = 0; z <= 90; z += 5) {
      const ClearSky sky(z * radians, turbidity, grey);
      EXPECT_TRUE(isFinite(sky.sun()));
      EXPECT_GE(minimum(sky.sun()), 0);
      for (int i = 0; i <= 10; ++i) {
        for (int j = 0; j <= 10; ++j) {
          const Color c = sky.sky(i / 10.0, j / 10.0 * pi);
          EXPECT_TRUE(isFinite(c)) << turbidity << ' ' << z << ' ' << i << ' ' << j;
          EXPECT_GE(minimum(c), 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace aerosol::render

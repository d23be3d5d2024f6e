#include "core/render/clear_sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace aerosol::render {
namespace {

using std::numbers::pi;

/// cd/m² of one unit of luminance.
constexpr double candelas = 683.002 * 106.857;

double luminance(Color c) {
  return 0.2126729 * static_cast<double>(c.r) + 0.7151522 * static_cast<double>(c.g) +
         0.0721750 * static_cast<double>(c.b);
}

TEST(ClearSky, HasTheModelsZenith) {
  // By hand, for a turbidity of 3 and the sun at 45 degrees: χ = (4/9 - 3/120) π/2.
  const ClearSky sky(pi / 4, 3);
  const double chi = (4.0 / 9 - 0.025) * pi / 2;
  const double zenith = (4.0453 * 3 - 4.9710) * std::tan(chi) - 0.2155 * 3 + 2.4192;
  EXPECT_NEAR(sky.luminance(1, pi / 4) * candelas / (1000 * zenith), 1, 1e-9);
  EXPECT_NEAR(luminance(sky.sky(1, pi / 4)) / sky.luminance(1, pi / 4), 1, 1e-4);
}

TEST(ClearSky, IsBrightAtTheSunAndBlueAwayFromIt) {
  const ClearSky sky(pi / 3, 2.5);
  const Color near = sky.sky(std::cos(pi / 3), 0.02), away = sky.sky(std::cos(pi / 6), pi / 2);
  EXPECT_GT(luminance(near), 4 * luminance(away));
  EXPECT_GT(away.b, 1.5f * away.r);
  EXPECT_LT(near.b / near.r, away.b / away.r);
}

/// The sun at noon gives about 100 000 lux, sky and sun at 5 degrees two orders less.
TEST(ClearSky, TheSunFadesAndReddensTowardsTheHorizon) {
  const double solidAngle = 2 * pi * (1 - std::cos(0.5338 / 2 * pi / 180));
  const Color high = ClearSky(0, 2).sun(), low = ClearSky(85 * pi / 180, 2).sun();
  const double lux = luminance(high) * solidAngle * candelas;
  EXPECT_GT(lux, 95000);
  EXPECT_LT(lux, 125000);
  EXPECT_LT(luminance(low), 0.3 * luminance(high));
  EXPECT_GT(low.r / low.g, high.r / high.g);
  EXPECT_LT(low.b / low.g, high.b / high.g);
  EXPECT_LT(luminance(ClearSky(0, 8).sun()), luminance(high));
}

TEST(ClearSky, IsFiniteAndNeverNegative) {
  for (const double turbidity : {1.7, 2.0, 3.0, 6.0, 10.0}) {
    for (int z = 0; z <= 90; z += 5) {
      const ClearSky sky(z * pi / 180, turbidity);
      EXPECT_TRUE(isFinite(sky.sun()));
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

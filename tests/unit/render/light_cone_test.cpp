#include "core/render/light_cone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/volume/equiangular.h"

namespace aerosol::render {
namespace {

using Double3 = std::array<double, 3>;

Double3 unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Double3 v{normal(random), normal(random), normal(random)};
  const double size = std::hypot(v[0], v[1], v[2]);
  for (double& x : v) x /= size;
  return v;
}

/// By the angle between axis and the point.
bool isInside(const LightCone& cone, const Double3& toApex, const Double3& along, double t) {
  Double3 v;
  for (std::size_t i = 0; i < 3; ++i) v[i] = t * along[i] - toApex[i];
  const double forward = v[0] * cone.axis[0] + v[1] * cone.axis[1] + v[2] * cone.axis[2];
  const double size = std::hypot(v[0], v[1], v[2]);
  return forward > 0 && std::acos(std::min(forward / size, 1.0)) < std::atan(cone.tangent);
}

/// Points along many lines, wherever they are not at the very edge.
TEST(LightCone, HoldsThePointsOfALineThatAreInsideOfIt) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int insideCount = 0;
  for (int i = 0; i < 20000; ++i) {
    const LightCone cone{unit(random), std::tan(0.5 * (uniform(random) + 1) * 1.5 + 0.01)};
    const Double3 along = unit(random), toApex{3 * uniform(random), 3 * uniform(random), 3 * uniform(random)};
    const ConeStretch stretch = insideCone(cone, toApex, along);
    for (int k = 0; k < 50; ++k) {
      const double t = 8 * uniform(random);
      if (std::fabs(t - stretch.begin) < 1e-6 || std::fabs(t - stretch.end) < 1e-6) continue;
      const bool expected = isInside(cone, toApex, along, t);
      insideCount += expected;
      ASSERT_EQ(t > stretch.begin && t < stretch.end, expected) << i << ' ' << t;
    }
  }
  EXPECT_GT(insideCount, 50000);
}

TEST(LightCone, IsExactWhereItIsNarrow) {
  const double tangent = std::tan(1e-4 * 3.14159265358979 / 180);
  const ConeStretch across = insideCone({{0, 0, 1}, tangent}, {5, 0, -2}, {1, 0, 0});
  EXPECT_NEAR(across.end - across.begin, 4 * tangent, 1e-12);
  EXPECT_NEAR(0.5 * (across.begin + across.end), 5, 1e-12);
  const ConeStretch beside = insideCone({{0, 0, 1}, tangent}, {5, 3 * tangent, -2}, {1, 0, 0});
  EXPECT_FALSE(beside.begin < beside.end);
}

TEST(LightCone, AlongItsAxisAndThroughItsTip) {
  const LightCone cone{{0, 0, 1}, 0.5};
  const ConeStretch ahead = insideCone(cone, {0, 0, 3}, {0, 0, 1});
  EXPECT_EQ(ahead.begin, 3);
  EXPECT_EQ(ahead.end, std::numeric_limits<double>::infinity());
  const ConeStretch behind = insideCone(cone, {0, 0, 3}, {0, 0, -1});
  EXPECT_EQ(behind.begin, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(behind.end, -3);
  const ConeStretch across = insideCone(cone, {3, 0, 0}, {1, 0, 0});
  EXPECT_FALSE(across.begin < across.end);
}

TEST(LightCone, IsNoneWhereAnglesAreChanged) {
  Matrix4 matrix = identityMatrix();
  EXPECT_FALSE(coneAlongZ(matrix, 0.5).isWhole());
  for (std::size_t i = 0; i < 3; ++i) matrix[i][i] = 3;
  EXPECT_FALSE(coneAlongZ(matrix, 0.5).isWhole());
  matrix[0][0] = 4;
  EXPECT_TRUE(coneAlongZ(matrix, 0.5).isWhole());
  matrix[0][0] = 3;
  matrix[0][1] = 0.5;
  EXPECT_TRUE(coneAlongZ(matrix, 0.5).isWhole());
}

TEST(RayStretches, KeepWhatIsInFrontOfAPart) {
  volume::RayStretches all;
  all.add(1, 2, {Color(3), Color(1)});
  all.add(4, 6, {Color(0.5f), Color(0.25f)});
  const volume::RayStretches part = all.within(5, 9);
  ASSERT_EQ(part.all().size(), 1u);
  EXPECT_EQ(part.begin(), 5);
  EXPECT_EQ(part.end(), 6);
  EXPECT_TRUE(part.isKnown());
  EXPECT_EQ(part.depthBefore()[1], 3 + 0.5);
  EXPECT_EQ(part.extinction(0).sigmaS.g, 0.25f);
  EXPECT_TRUE(all.within(2, 4).isEmpty());
  EXPECT_EQ(all.within(0, 5).depthBefore()[0], 0);
  EXPECT_EQ(all.within(0, 5).length(), 2);
}

}  // namespace
}  // namespace aerosol::render

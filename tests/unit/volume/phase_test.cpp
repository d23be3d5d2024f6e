#include "core/volume/phase.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aerosol::volume {
namespace {

Vector<World> at(double angle) { return {static_cast<float>(std::sin(angle)), 0, static_cast<float>(std::cos(angle))}; }

TEST(Deflection, KeepsDigitsNextToForwardAndBackward) {
  const Vector<World> forward{0, 0, 1};
  for (const double angle : {1e-6, 1e-4, 1e-2, 0.5}) {
    const double expected = 2 * std::sin(angle / 2) * std::sin(angle / 2);
    EXPECT_NEAR(Deflection::between(forward, at(angle)).oneMinusCosine / expected, 1, 1e-6) << angle;
    EXPECT_NEAR(Deflection::between(forward, -at(angle)).onePlusCosine / expected, 1, 1e-6) << angle;
  }
}

TEST(Deflection, HasBothPartsOfTheSameCosine) {
  for (double angle = 0; angle < 3.14; angle += 0.1) {
    const Deflection d = Deflection::between({0, 0, 1}, at(angle));
    EXPECT_NEAR(d.oneMinusCosine + d.onePlusCosine, 2, 1e-12);
    EXPECT_NEAR(d.cosine(), std::cos(angle), 1e-6);
  }
  EXPECT_EQ(Deflection::between({0, 0, 1}, {0, 0, 1}).oneMinusCosine, 0);
  EXPECT_EQ(Deflection::between({0, 0, 1}, {0, 0, -1}).onePlusCosine, 0);
  EXPECT_EQ(Deflection::fromCosine(-0.25).onePlusCosine, 0.75);
}

}  // namespace
}  // namespace aerosol::volume

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/render/medium_phase.h"
#include "core/render/registry.h"
#include "plugins/registration.h"

namespace aerosol::render {
namespace {

using volume::Deflection;
using volume::PhaseFunction;

class HenyeyGreensteinTest : public ::testing::Test {
 protected:
  HenyeyGreensteinTest() {
    registerPlugins(registry_);
    phase_ = registry_.phase("henyey_greenstein");
  }
  float evaluate(float g, double cosine) const { return phase_->evaluate({&g, 1}, Deflection::fromCosine(cosine)); }
  double sampledCosine(float g, float u) const {
    return static_cast<double>(phase_->sample({&g, 1}, {0, 0, 1}, {u, 0.25f}).direction.z);
  }

  Registry registry_;
  const PhaseFunction* phase_ = nullptr;
};

TEST_F(HenyeyGreensteinTest, MatchesTheFormula) {
  ASSERT_TRUE(phase_);
  for (const float g : {-0.9f, -0.3f, 0.0f, 1e-8f, 0.5f, 0.99f}) {
    for (const double cosine : {-1.0, -0.4, 0.0, 0.7, 1.0}) {
      const double a = static_cast<double>(g);
      const double expected = (1 - a * a) / (4 * std::numbers::pi * std::pow(1 + a * a - 2 * a * cosine, 1.5));
      EXPECT_NEAR(evaluate(g, cosine) / expected, 1, 1e-6) << g << ' ' << cosine;
    }
  }
}

TEST_F(HenyeyGreensteinTest, InvertsItsDistribution) {
  // P(cos < c) = (1 - g²) / 2g · ((1 + g² - 2 g c)^(-1/2) - (1 + g)^-1).
  for (const float g : {-0.8f, -0.2f, 0.1f, 0.7f}) {
    for (const float u : {0.01f, 0.3f, 0.5f, 0.99f}) {
      const double a = static_cast<double>(g), c = sampledCosine(g, u);
      const double below = (1 - a * a) / (2 * a) * (1 / std::sqrt(1 + a * a - 2 * a * c) - 1 / (1 + a));
      EXPECT_NEAR(below, static_cast<double>(u), 1e-5) << g;
    }
  }
}

TEST_F(HenyeyGreensteinTest, IsContinuousThroughZero) {
  for (const float u : {0.0f, 0.2f, 0.5f, 0.8f}) {
    for (const float g : {0.0f, 1e-8f, -1e-8f, 1e-30f}) {
      EXPECT_NEAR(sampledCosine(g, u), 2 * static_cast<double>(u) - 1, 1e-6);
    }
  }
}

TEST_F(HenyeyGreensteinTest, EndsAreASingleDirection) {
  for (const float g : {1.0f, -1.0f, 0x1.fffffep-1f}) {
    const auto s = phase_->sample({&g, 1}, {0, 0.6f, 0.8f}, {0.3f, 0.3f});
    EXPECT_TRUE(s.isDelta);
    EXPECT_EQ(s.direction, g > 0 ? Vector<World>(0, 0.6f, 0.8f) : Vector<World>(0, -0.6f, -0.8f));
    EXPECT_EQ(evaluate(g, 1), 0);
  }
}

TEST_F(HenyeyGreensteinTest, EveryRandomNumberGivesAUnitDirection) {
  for (const float g : {-0.9999f, -0.5f, 0.0f, 0.9999f}) {
    for (const float u : {0.0f, 0x1p-24f, 0.5f, 0x1.fffffep-1f}) {
      for (const float v : {0.0f, 0.5f, 0x1.fffffep-1f}) {
        const auto s = phase_->sample({&g, 1}, {0, 0, -1}, {u, v});
        EXPECT_NEAR(length(s.direction), 1, 1e-6);
        EXPECT_TRUE(std::isfinite(s.pdf) && s.pdf > 0);
        EXPECT_EQ(s.weight, 1);
      }
    }
  }
}

TEST(MediumPhase, RayleighIsItsFormula) {
  Registry registry;
  registerPlugins(registry);
  scene::Phase phase;
  phase.type = scene::PhaseType::rayleigh;
  const auto rayleigh = makePhase(phase, registry);
  for (const double c : {-1.0, -0.3, 0.0, 0.8, 1.0}) {
    const auto expected = 3 / (16 * std::numbers::pi) * (1 + c * c);
    EXPECT_NEAR(static_cast<double>(rayleigh->evaluate({}, Deflection::fromCosine(c))) / expected, 1, 1e-6);
  }
}

TEST(MediumPhase, DropletsScatterAsMieTheoryHasThem) {
  Registry registry;
  registerPlugins(registry);
  scene::Phase phase;
  phase.type = scene::PhaseType::mie;
  const auto meanCosine = [&](float diameter_um) {
    phase.particleDiameter_um = diameter_um;
    return static_cast<double>(makePhase(phase, registry)->meanCosine({}));
  };
  // Asymmetry of water droplets in visible light: clouds 0.85 to 0.89, tiny particles scatter evenly. (van de Hulst
  // 1957; Hu and Stamnes 1993)
  EXPECT_NEAR(meanCosine(10), 0.865, 0.01);
  EXPECT_NEAR(meanCosine(20), 0.875, 0.01);
  EXPECT_NEAR(meanCosine(0.01f), 0, 0.01);
  // The ranges of the fit meet.
  EXPECT_NEAR(meanCosine(0.0999f), meanCosine(0.1001f), 0.02);
  EXPECT_NEAR(meanCosine(1.4999f), meanCosine(1.5001f), 0.005);
  EXPECT_NEAR(meanCosine(4.9999f), meanCosine(5.0001f), 0.002);
}

}  // namespace
}  // namespace aerosol::render

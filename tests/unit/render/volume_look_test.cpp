#include "core/render/volume_look.h"

#include <gtest/gtest.h>

#include <random>

#include "core/render/linked_lights.h"

namespace aerosol::render {
namespace {

scene::Volume volumeWith(const scene::VolumeControls& controls) {
  scene::Volume volume;
  volume.controls = controls;
  volume.origin.location = {"a.xml", 3, 5};
  volume.origin.parameters["density_ramp"] = {"a.xml", 4, 7};
  volume.origin.parameters["lights"] = {"a.xml", 5, 7};
  return volume;
}

Result<std::vector<bool>> named(const scene::Volume& volume, std::span<const std::string> ids,
                                std::span<const std::string> shining) {
  return namedLights(volume.controls.lights, volume.origin, ids, shining);
}

VolumeLook look(const scene::VolumeControls& controls) {
  const auto made = lookOf(volumeWith(controls));
  EXPECT_TRUE(made);
  EXPECT_TRUE(made && *made);
  return **made;
}

volume::Coefficients coefficients(Color sigmaT, Color sigmaS) {
  volume::Coefficients c;
  c.sigmaT = sigmaT;
  c.sigmaS = sigmaS;
  c.emission = Color(1);
  c.lobes[0] = {sigmaS, 0.5f};
  c.lobeCount = 1;
  return c;
}

TEST(VolumeLooks, DefaultsChangeNothing) {
  const auto none = lookOf(volumeWith({}));
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(VolumeLooks, FactorsAndRamps) {
  const VolumeLook l = look({.density = 2,
                             .color = {0.5f, 1, 0.25f},
                             .emission = 3,
                             .densityRamp = "0: 0; 2: 1; 4: 3",
                             .colorRamp = "1: 1; 3: 0 0.5 1"});
  volume::Coefficients c = coefficients({1, 3, 2}, {1, 1, 1});
  l.apply(c);  // The largest channel is 3: factor 2 · 2, colour (0, 0.5, 1).
  EXPECT_EQ(c.sigmaT, Color(4, 12, 8));
  EXPECT_EQ(c.sigmaS, Color(0, 2, 1));
  EXPECT_EQ(c.lobes[0].sigmaS, c.sigmaS);
  EXPECT_EQ(c.emission, Color(3));
  EXPECT_EQ(l.largestFactor(), 6);
  EXPECT_EQ(l.factorAt(100), 6);
}

TEST(VolumeLooks, BoundsHoldAllPoints) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 5);
  const VolumeLook l = look({.density = 1.7f, .emission = 0.3f, .densityRamp = "0.5: 0.2; 1: 3; 1.5: 0.1; 4: 2"});
  for (int i = 0; i < 20000; ++i) {
    const float a = uniform(random), b = uniform(random);
    volume::BoxKnowledge k;
    k.ranges = {std::min(a, b), std::max(a, b), std::max(a, b), 0, 2};
    l.apply(k);
    for (int j = 0; j < 10; ++j) {
      const float t = uniform(random) / 5, d = std::min(a, b) + (std::max(a, b) - std::min(a, b)) * t;
      volume::Coefficients c = coefficients(Color(d), Color(d));
      l.apply(c);
      ASSERT_LE(c.sigmaT.r, k.ranges.extinctionHigh);
      ASSERT_GE(c.sigmaT.r, k.ranges.extinctionLow);
      ASSERT_LE(c.sigmaS.r, k.ranges.scatteringHigh);
      ASSERT_LE(c.emission.r, k.ranges.emissionHigh);
    }
  }
}

TEST(VolumeLooks, BadRampsAreErrorsAtTheirPlace) {
  for (const char* bad :
       {"1", "1:", "0: 1; 0: 2", "1: 1; 0: 1", "0: -1", "0: x", "0: 1 2", "0 1: 2", "nan: 1", "0: 1e99"}) {
    const auto made = lookOf(volumeWith({.densityRamp = bad}));
    ASSERT_FALSE(made) << bad;
    EXPECT_EQ(made.errors().entries()[0].location.line, 4) << bad;
  }
}

TEST(LightLinks, NameLightsById) {
  const std::vector<std::string> ids{"key", "", "rim", "burnt_out"}, shining{"key", "", "rim"};
  EXPECT_EQ(*named(volumeWith({.lights = "rim , key"}), ids, shining), (std::vector<bool>{true, false, true, false}));
  EXPECT_EQ(*named(volumeWith({.lights = "none"}), ids, shining), (std::vector<bool>{false, false, false, false}));
  const auto wrong = named(volumeWith({.lights = "key,fill"}), ids, shining);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.errors().entries()[0].location.line, 5);
  EXPECT_EQ(wrong.errors().entries()[0].notes[0], "the lights are: key, rim");
}

}  // namespace
}  // namespace aerosol::render

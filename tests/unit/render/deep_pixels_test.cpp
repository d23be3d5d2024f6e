#include "core/render/aov/deep_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aerosol::render {
namespace {

AovDeep layoutOf(std::size_t slices, bool isChromatic = false) {
  AovDeep deep;
  for (std::size_t i = 0; i <= slices; ++i)
    deep.depths.push_back(1 + static_cast<float>(i) / static_cast<float>(slices));
  deep.isChromatic = isChromatic;
  return deep;
}

/// Sums over one sample with opacity and light by slice, equal in all channels unless they are told apart.
struct Sums {
  explicit Sums(const AovDeep& layout) : deep(layout), values(layout.width(), 0.0) {}

  void medium(std::size_t slice, Color opacity, Color light) {
    for (std::uint32_t c = 0; c < deep.opacities(); ++c)
      values[deep.opacityAt(slice) + c] += static_cast<double>(opacity[static_cast<int>(c)]);
    for (std::uint32_t c = 0; c < 3; ++c)
      values[deep.lightAt(slice) + c] += static_cast<double>(light[static_cast<int>(c)]);
  }
  void surface(float depth, float opacity, Color light) {
    const std::size_t slice = deep.sliceOf(depth);
    medium(slice, Color(opacity), light);
    values[deep.surfaceAt(slice)] += static_cast<double>(opacity);
    values[deep.surfaceAt(slice) + 1] += static_cast<double>(opacity * depth);
  }

  const AovDeep& deep;
  std::vector<double> values;
};

/// What lies in front of a depth, by the rule for cutting deep samples.
DeepSample inFront(const std::vector<DeepSample>& samples, float depth) {
  DeepSample flat;
  Color left(1.0f);
  for (const DeepSample& s : samples) {
    if (s.front >= depth) break;
    const float part = s.back > depth ? (depth - s.front) / (s.back - s.front) : 1;
    for (int c = 0; c < 3; ++c) {
      const float opacity = 1 - std::pow(1 - s.opacity[c], part);
      const float share = s.opacity[c] > 0 ? opacity / s.opacity[c] : part;
      flat.light[c] += left[c] * s.light[c] * share;
      left[c] *= 1 - opacity;
    }
  }
  flat.opacity = Color(1.0f) - left;
  return flat;
}

TEST(DeepPixels, HaveTheFormulasOfIntervals) {
  const AovDeep deep = layoutOf(3);
  Sums sums(deep);
  sums.medium(0, Color(0.5f), Color(0.1f));
  sums.medium(1, Color(0.25f), Color(0.3f));
  sums.medium(2, Color(0.125f), Color(0.2f));
  const auto samples = deepSamples(deep, sums.values, 1, 0);
  ASSERT_EQ(samples.size(), 3u);
  // 1 - T(back) / T(front) with T = 1, 1/2, 1/4, 1/8, and light over T(front).
  EXPECT_FLOAT_EQ(samples[0].opacity.r, 0.5f);
  EXPECT_FLOAT_EQ(samples[1].opacity.r, 0.5f);
  EXPECT_FLOAT_EQ(samples[2].opacity.r, 0.5f);
  EXPECT_FLOAT_EQ(samples[1].light.g, 0.6f);
  EXPECT_FLOAT_EQ(samples[2].light.b, 0.8f);
  EXPECT_FLOAT_EQ(samples[1].front, deep.depths[1]);
  EXPECT_FLOAT_EQ(samples[1].back, deep.depths[2]);
}

TEST(DeepPixels, OverEachOtherAreTheWhole) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> noise(-0.05f, 0.15f), unit(0, 1);
  for (int repetition = 0; repetition < 200; ++repetition) {
    const bool isChromatic = repetition % 2 == 1;
    const AovDeep deep = layoutOf(24, isChromatic);
    Sums sums(deep);
    Color opacity, light;
    // Signed noise, but less light ends than there is, and there is some.
    for (std::size_t i = 0; i < 24; ++i) {
      Color a(0.6f * noise(random)), l(noise(random), noise(random), noise(random));
      if (isChromatic) a = {0.6f * noise(random), 0.5f * noise(random), 0.4f * noise(random)};
      if (i == 0) a += Color(0.05f);
      if (i == 23) l += Color(1.0f);
      sums.medium(i, a, l);
      opacity += a;
      light += l;
    }
    if (maximum(opacity) > 0.95f || minimum(opacity) < 0.05f) continue;
    for (const double error : {0.0, 0.01, 0.2}) {
      const auto samples = deepSamples(deep, sums.values, 1, error);
      const DeepSample flat = flatten(samples);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(flat.light[c], light[c], 2e-5);
        EXPECT_NEAR(flat.opacity[c], opacity[c], 2e-5);
      }
      float before = 0;
      for (const DeepSample& s : samples) {
        EXPECT_GE(s.front, before);
        EXPECT_GE(s.back, s.front);
        before = s.back;
        EXPECT_GE(minimum(s.opacity), 0);
        EXPECT_LE(maximum(s.opacity), 1);
        EXPECT_GE(minimum(s.light), 0);
      }
    }
  }
}

TEST(DeepPixels, AreAsManyAsTheErrorAsksFor) {
  // Fog of two densities, which glows as it is dense: two samples say all of it.
  const AovDeep deep = layoutOf(64);
  Sums sums(deep);
  double left = 1;
  for (std::size_t i = 0; i < 64; ++i) {
    const double next = left * std::exp(i < 24 ? -0.005 : -0.05);
    const auto opacity = static_cast<float>(left - next);
    sums.medium(i, Color(opacity), Color(2 * opacity));
    left = next;
  }
  const auto all = deepSamples(deep, sums.values, 1, 0);
  EXPECT_EQ(all.size(), 64u);
  EXPECT_LE(deepSamples(deep, sums.values, 1, 1e-3).size(), 3u);
  std::size_t before = 65;
  for (const double error : {0.0, 1e-4, 1e-2, 0.3}) {
    const auto samples = deepSamples(deep, sums.values, 1, error);
    EXPECT_LE(samples.size(), before);
    before = samples.size();
    const float whole = flatten(all).light.r;
    for (std::size_t i = 0; i <= 64; ++i) {
      const DeepSample exact = inFront(all, deep.depths[i]), joined = inFront(samples, deep.depths[i]);
      EXPECT_NEAR(joined.opacity.r, exact.opacity.r, error + 1e-5);
      EXPECT_NEAR(joined.light.r, exact.light.r, (error + 1e-5) * static_cast<double>(whole));
    }
  }
}

TEST(DeepPixels, SurfacesStandWhereTheyAre) {
  const AovDeep deep = layoutOf(10);
  Sums sums(deep);
  sums.medium(2, Color(0.2f), Color(0.1f));
  sums.surface(1.537f, 0.8f, Color(0.4f));
  const auto samples = deepSamples(deep, sums.values, 1, 0.01);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_FLOAT_EQ(samples[1].front, 1.537f);
  EXPECT_EQ(samples[1].front, samples[1].back);
  EXPECT_FLOAT_EQ(samples[1].opacity.r, 1);
  EXPECT_FLOAT_EQ(samples[1].light.r, 0.5f);
}

TEST(DeepPixels, LightFromBehindWhatHidesAllIsKept) {
  const AovDeep deep = layoutOf(4);
  Sums sums(deep);
  sums.medium(0, Color(1), Color(0.25f));
  sums.medium(3, Color(), Color(0.5f));
  const auto samples = deepSamples(deep, sums.values, 1, 0);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_FLOAT_EQ(samples[0].light.g, 0.75f);
  EXPECT_TRUE(deepSamples(deep, {}, 0, 0).empty());
}

TEST(DeepPixels, MeansAreOverSamples) {
  const AovDeep deep = layoutOf(2);
  Sums sums(deep);
  sums.medium(1, Color(2), Color(3));
  const auto samples = deepSamples(deep, sums.values, 4, 0);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_FLOAT_EQ(samples[0].opacity.r, 0.5f);
  EXPECT_FLOAT_EQ(samples[0].light.r, 0.75f);
}

}  // namespace
}  // namespace aerosol::render

#include "core/volume/distance_sample.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace aerosol::volume {
namespace {

Coefficients withLobes(std::initializer_list<Lobe> lobes) {
  Coefficients c;
  for (const Lobe& lobe : lobes) {
    c.lobes[c.lobeCount++] = lobe;
    c.sigmaS += lobe.sigmaS;
  }
  c.sigmaT = c.sigmaS;
  return c;
}

/// Of constant media and one that is answered for.
DistanceSample chooseLobe(std::span<const Medium* const> media, const Coefficients& answer, Color weight, float u) {
  DistanceSample sample;
  const auto forEach = [&](auto&& use) {
    for (const Medium* medium : media) use(*medium, medium->constant ? *medium->constant : answer);
  };
  volume::chooseLobe(forEach, weight, u, sample);
  return sample;
}

/// Two media: a constant one with one lobe, one with two lobes that is answered for.
class ChooseLobe : public ::testing::Test {
 protected:
  ChooseLobe() { constant_.constant = withLobes({{Color(1, 2, 3), 0.1f}}); }

  DistanceSample choose(float u) const { return chooseLobe(media_, answer_, Color(0.5f), u); }

  Medium constant_, varying_;
  const std::array<const Medium*, 2> media_{&constant_, &varying_};
  const Coefficients answer_ = withLobes({{Color(4, 0, 2), 0.5f}, {Color(0, 6, 0), -0.5f}});
};

TEST_F(ChooseLobe, InProportionToTheMeanScattering) {
  std::map<std::pair<const Medium*, float>, int> counts;
  constexpr int steps = 60000;
  for (int i = 0; i < steps; ++i) {
    const DistanceSample sample = choose((static_cast<float>(i) + 0.5f) / steps);
    ++counts[{sample.medium, sample.anisotropy}];
  }
  ASSERT_EQ(counts.size(), 3u);  // The means are 2, 2 and 2.
  EXPECT_NEAR((counts[{&constant_, 0.1f}]), steps / 3, 2);
  EXPECT_NEAR((counts[{&varying_, 0.5f}]), steps / 3, 2);
  EXPECT_NEAR((counts[{&varying_, -0.5f}]), steps / 3, 2);
}

TEST_F(ChooseLobe, WeightsAddUpToAllScattering) {
  Color mean;
  constexpr int steps = 3000;
  for (int i = 0; i < steps; ++i) mean += choose((static_cast<float>(i) + 0.5f) / steps).weight * (1.0f / steps);
  EXPECT_NEAR(mean.r, 0.5f * 5, 5e-3);
  EXPECT_NEAR(mean.g, 0.5f * 8, 5e-3);
  EXPECT_NEAR(mean.b, 0.5f * 5, 5e-3);
}

TEST(ChooseLobeEdges, OfManyMedia) {
  std::vector<Medium> media(9);
  std::vector<const Medium*> pointers;
  for (Medium& medium : media) {
    medium.constant = withLobes({{Color(1), 0.1f}});
    pointers.push_back(&medium);
  }
  for (std::size_t i = 0; i < media.size(); ++i) {
    const DistanceSample sample = chooseLobe(pointers, {}, Color(1), (static_cast<float>(i) + 0.5f) / 9);
    EXPECT_EQ(sample.medium, &media[i]);
    EXPECT_FLOAT_EQ(sample.weight.g, 9);
  }
}

TEST_F(ChooseLobe, EndsOfTheRangeOfU) {
  EXPECT_EQ(choose(0).medium, &constant_);
  EXPECT_EQ(choose(0).event, DistanceEvent::scattered);
  EXPECT_EQ(choose(0x1.fffffep-1f).anisotropy, -0.5f);
  EXPECT_EQ(choose(0x1.fffffep-1f).event, DistanceEvent::scattered);
}

TEST(ChooseLobeEdges, NothingScatters) {
  Medium medium;
  medium.constant = withLobes({{Color(), 0.3f}});
  const Medium* media[] = {&medium};
  const DistanceSample sample = chooseLobe(media, {}, Color(1), 0.5f);
  EXPECT_EQ(sample.event, DistanceEvent::absorbed);
  EXPECT_TRUE(isBlack(sample.weight));
}

TEST(ChooseLobeEdges, ALobeWithoutScatteringIsNeverChosen) {
  Medium medium;
  medium.constant = withLobes({{Color(), 0.1f}, {Color(1), 0.2f}, {Color(), 0.3f}});
  const Medium* media[] = {&medium};
  for (const float u : {0.0f, 0.5f, 0x1.fffffep-1f}) {
    const DistanceSample sample = chooseLobe(media, {}, Color(1), u);
    EXPECT_EQ(sample.anisotropy, 0.2f);
    EXPECT_EQ(sample.weight, Color(1));
  }
}

TEST(ChooseLobeEdges, TinyAndHugeScatteringTogether) {
  Medium medium;
  medium.constant = withLobes({{Color(1e12f), 0.1f}, {Color(1e-30f), 0.2f}});
  const Medium* media[] = {&medium};
  const DistanceSample sample = chooseLobe(media, {}, Color(1), 0.999f);
  EXPECT_TRUE(isFinite(sample.weight));
  EXPECT_EQ(sample.weight, Color(1e12f));
}

TEST(DistanceSampleTest, PdfIsTheExponentialOfItsLogarithm) {
  DistanceSample sample;
  EXPECT_EQ(sample.pdf(), 1);
  sample.logPdf = -10000;
  EXPECT_EQ(sample.pdf(), 0);
  sample.logPdf = std::log(0.25);
  EXPECT_DOUBLE_EQ(sample.pdf(), 0.25);
}

}  // namespace
}  // namespace aerosol::volume

#include <gtest/gtest.h>

#include <functional>

#include "core/render/sample_stream.h"
#include "tests/statistical/statistics.h"

// Both kinds of sampler: uniform in each slot and in pairs of slots, uncorrelated between pixels, unbiased in
// estimates.

namespace aerosol::render {
namespace {

using test::agrees;
using test::countsAgree;
using test::RunningMean;
using test::seedOfTest;
using test::zScoresAreNormal;

class Samplers : public ::testing::TestWithParam<SamplerKind> {
 protected:
  SampleStream stream(int pixel, std::uint32_t sample) const {
    return {GetParam(), seedOfTest(), pixel % 64, pixel / 64, sample};
  }
};

/// Counts of (x, y) in a square of cells.
struct SquareCounts {
  static constexpr int side = 16;
  std::vector<double> observed = std::vector<double>(side * side);
  double total = 0;

  void add(float x, float y) {
    ++observed[static_cast<std::size_t>(static_cast<int>(x * side) * side + static_cast<int>(y * side))];
    ++total;
  }
  ::testing::AssertionResult areUniform() const {
    return countsAgree(observed, std::vector<double>(observed.size(), total / (side * side)));
  }
};

/// One sample of many pixels: the numbers are independent there, also the stratified ones.
TEST_P(Samplers, SlotsAreUniformAndIndependentOverPixels) {
  for (const std::uint32_t slot : {0u, 1u, 7u, 63u, 64u, 200u}) {
    SquareCounts within, between, neighbours, withHash;
    for (int pixel = 0; pixel < 30000; ++pixel) {
      SampleStream a = stream(pixel, 5);
      a.skipTo(slot);
      const float single = SampleStream(a).next1D();
      const auto [x, y] = a.next2D();
      within.add(x, y);
      between.add(single, a.next1D());
      withHash.add(x, a.nextHash());
      SampleStream b = stream(pixel + 1, 5);
      b.skipTo(slot);
      neighbours.add(x, b.next2D()[0]);
    }
    EXPECT_TRUE(within.areUniform()) << slot;
    EXPECT_TRUE(between.areUniform()) << slot;
    EXPECT_TRUE(neighbours.areUniform()) << slot;
    EXPECT_TRUE(withHash.areUniform()) << slot;
  }
}

/// Samples of one pixel in two different slots: no alignment, whatever the slots' own stratification.
TEST_P(Samplers, SlotsArePairwiseIndependentWithinAPixel) {
  for (const auto& [first, second] : {std::pair{0u, 1u}, {0u, 2u}, {3u, 17u}, {60u, 70u}}) {
    SquareCounts counts;
    for (int pixel = 0; pixel < 120; ++pixel) {
      for (std::uint32_t sample = 0; sample < 256; ++sample) {
        SampleStream a = stream(pixel, sample), b = a;
        a.skipTo(first);
        b.skipTo(second);
        counts.add(a.next1D(), b.next2D()[1]);
      }
    }
    EXPECT_TRUE(counts.areUniform()) << first << ' ' << second;
  }
}

/// ∫ over four slots (eight dimensions) of a product, whose integral is known; a pixel is one scramble.
double integrand(SampleStream& stream) {
  double product = 1;
  for (int i = 0; i < 4; ++i) {
    const auto [x, y] = stream.next2D();
    product *= (0.5 + static_cast<double>(x)) * 1.5 * std::sqrt(static_cast<double>(y));
  }
  return product;
}

struct PixelEstimates {
  RunningMean means;
  std::vector<double> values;
};

PixelEstimates estimate(const std::function<SampleStream(int, std::uint32_t)>& stream, double scale) {
  PixelEstimates result;
  for (int pixel = 0; pixel < 4000; ++pixel) {
    RunningMean mean;
    for (std::uint32_t sample = 0; sample < 64; ++sample) {
      SampleStream s = stream(pixel, sample);
      mean.add(scale * integrand(s));
    }
    result.means.add(mean.mean());
    result.values.push_back(mean.mean());
  }
  return result;
}

TEST_P(Samplers, EstimatesAreUnbiased) {
  const PixelEstimates e = estimate([this](int pixel, std::uint32_t i) { return stream(pixel, i); }, 1);
  EXPECT_TRUE(agrees(e.means, 1));
  std::vector<double> scores;
  const double deviation = std::sqrt(e.means.variance() * 20);
  for (std::size_t block = 0; block + 20 <= e.values.size(); block += 20) {
    double sum = 0;
    for (std::size_t i = 0; i < 20; ++i) sum += e.values[block + i] - 1;
    scores.push_back(sum / deviation);
  }
  EXPECT_TRUE(zScoresAreNormal(scores));
}

TEST_P(Samplers, APlantedErrorOfTwoPercentIsCaught) {
  const PixelEstimates e = estimate([this](int pixel, std::uint32_t i) { return stream(pixel, i); }, 1.02);
  EXPECT_FALSE(agrees(e.means, 1));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Samplers, ::testing::Values(SamplerKind::independent, SamplerKind::sobol));

TEST(SobolSampler, HasLessVarianceThanIndependentNumbers) {
  const auto variance = [](SamplerKind kind) {
    return estimate([=](int pixel, std::uint32_t i) { return SampleStream(kind, seedOfTest(), pixel, 0, i); }, 1)
        .means.variance();
  };
  EXPECT_LT(variance(SamplerKind::sobol), 0.5 * variance(SamplerKind::independent));
}

}  // namespace
}  // namespace aerosol::render

#include "core/image/denoise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace aerosol::image {
namespace {

constexpr int width = 48, height = 40;

/// About a normal distribution: the sum of twelve.
double noise(std::uint64_t key) {
  double sum = -6;
  for (std::uint32_t i = 0; i < 12; ++i) sum += static_cast<double>(randomFloat(key, i, 0));
  return sum;
}

/// A slope with a step in it, in red brightest.
double truth(int x, int y, int c) { return (0.2 + 0.01 * x + (y > 17 ? 1.5 : 0)) / (1 + c); }

struct Case {
  DenoiseInput input;
  double noisyError = 0;
};

/// With a deviation of the mean of 0.2 a pixel, and a feature that knows the step and the slope.
Case makeCase(double deviation) {
  Case made;
  DenoiseInput& in = made.input;
  in.width = width;
  in.height = height;
  const std::size_t values = 3 * static_cast<std::size_t>(width * height);
  for (Raster* raster : {&in.halfA, &in.halfB, &in.variance}) *raster = {3, std::vector<float>(values)};
  DenoiseFeature feature{{2, std::vector<float>(values / 3 * 2)}, {2, std::vector<float>(values / 3 * 2, 1e-4f)}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto pixel = static_cast<std::size_t>(y * width + x);
      for (int c = 0; c < 3; ++c) {
        const std::size_t at = 3 * pixel + static_cast<std::size_t>(c);
        const double a = std::sqrt(2.0) * deviation * noise(6 * at), b = std::sqrt(2.0) * deviation * noise(6 * at + 1);
        in.halfA.values[at] = static_cast<float>(truth(x, y, c) + a);
        in.halfB.values[at] = static_cast<float>(truth(x, y, c) + b);
        in.variance.values[at] = static_cast<float>(deviation * deviation);
        made.noisyError += std::pow((a + b) / 2, 2);
      }
      feature.mean.values[2 * pixel] = static_cast<float>((y > 17 ? 1 : 0) + 0.01 * noise(6 * pixel + 99991));
      feature.mean.values[2 * pixel + 1] = static_cast<float>(0.02 * x + 0.01 * noise(6 * pixel + 99992));
    }
  }
  in.features.push_back(std::move(feature));
  return made;
}

double errorOf(const Raster& result) {
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const auto at = 3 * static_cast<std::size_t>(y * width + x) + static_cast<std::size_t>(c);
        sum += std::pow(static_cast<double>(result.values[at]) - truth(x, y, c), 2);
      }
    }
  }
  return sum;
}

TEST(Denoise, TakesNoiseOffAndKeepsEdges) {
  const Case noisy = makeCase(0.2);
  const Raster result = denoise(noisy.input, {});
  ASSERT_EQ(result.values.size(), noisy.input.halfA.values.size());
  // Some sixty neighbours are averaged at least: the squared error falls by a factor of thirty.
  EXPECT_LT(errorOf(result), noisy.noisyError / 30);
  // Beside the step too, where others would blur it: 1.5 in red.
  const auto red = [&](int x, int y) { return result.values[3 * static_cast<std::size_t>(y * width + x)]; };
  for (int x = 4; x < width - 4; ++x) {
    EXPECT_NEAR(red(x, 17), truth(x, 17, 0), 0.25) << x;
    EXPECT_NEAR(red(x, 18), truth(x, 18, 0), 0.25) << x;
  }
}

TEST(Denoise, WorksWithoutFeatures) {
  Case noisy = makeCase(0.2);
  noisy.input.features.clear();
  EXPECT_LT(errorOf(denoise(noisy.input, {})), noisy.noisyError / 8);
}

TEST(Denoise, LeavesWhatHasNoNoiseAsItIs) {
  const Case clean = makeCase(0);
  const Raster result = denoise(clean.input, {});
  for (std::size_t i = 0; i < result.values.size(); ++i)
    ASSERT_NEAR(result.values[i], clean.input.halfA.values[i], 2e-3f) << i;
}

TEST(Denoise, ThreadsDoNotChangeABit) {
  const Case noisy = makeCase(0.3);
  EXPECT_EQ(denoise(noisy.input, {.threads = 1}).values, denoise(noisy.input, {.threads = 4}).values);
}

/// A picture of one pixel, and one narrower than the window.
TEST(Denoise, TakesPicturesOfAnySize) {
  for (const int n : {1, 3}) {
    DenoiseInput input{.width = n, .height = 1, .halfA = {}, .halfB = {}, .variance = {}, .features = {}};
    for (Raster* raster : {&input.halfA, &input.halfB, &input.variance})
      *raster = {3, std::vector<float>(3 * static_cast<std::size_t>(n), 0.5f)};
    for (const float value : denoise(input, {}).values) EXPECT_NEAR(value, 0.5f, 1e-5f);
  }
}

}  // namespace
}  // namespace aerosol::image

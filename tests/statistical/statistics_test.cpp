#include "tests/statistical/statistics.h"

#include <gtest/gtest.h>

namespace aerosol::test {
namespace {

TEST(Statistics, ChiSquaredTailMatchesTables) {
  EXPECT_NEAR(chiSquaredTail(3.841458820694124, 1), 0.05, 1e-10);
  EXPECT_NEAR(chiSquaredTail(18.307038053275146, 10), 0.05, 1e-10);
  EXPECT_NEAR(chiSquaredTail(124.34211340400408, 100), 0.05, 1e-10);
  EXPECT_NEAR(chiSquaredTail(77.92946516501726, 100), 0.95, 1e-9);
  EXPECT_NEAR(chiSquaredTail(10, 2), std::exp(-5.0), 1e-14);
}

TEST(Statistics, PValuesAreUniform) {
  Uniforms random(seedOfTest());
  std::vector<double> observed(20), expected(20, 100);
  for (int repeat = 0; repeat < 2000; ++repeat) {
    std::vector<double> counts(10), even(10, 30);
    for (int i = 0; i < 300; ++i) ++counts[static_cast<std::size_t>(random.next() * 10)];
    ++observed[std::min<std::size_t>(19, static_cast<std::size_t>(chiSquared(counts, even).p * 20))];
  }
  EXPECT_TRUE(countsAgree(observed, expected));
}

TEST(Statistics, MeansOfUniformsAgree) {
  Uniforms random(seedOfTest());
  RunningMean mean;
  for (int i = 0; i < 200000; ++i) mean.add(static_cast<double>(random.next()));
  EXPECT_TRUE(agrees(mean, 0.5));
  EXPECT_NEAR(mean.variance(), 1.0 / 12, 1e-3);
}

TEST(Statistics, APlantedErrorOfTwoPercentIsCaught) {
  Uniforms random(seedOfTest());
  RunningMean mean;
  std::vector<double> observed(50), expected(50, 4000), scores;
  for (int block = 0; block < 400; ++block) {
    RunningMean inBlock;
    for (int i = 0; i < 500; ++i) {
      const double u = std::min(0.999999, 1.02 * static_cast<double>(random.next()));
      mean.add(u);
      inBlock.add(u);
      ++observed[static_cast<std::size_t>(u * 50)];
    }
    scores.push_back(inBlock.z(0.5));
  }
  EXPECT_FALSE(agrees(mean, 0.5));
  EXPECT_FALSE(countsAgree(observed, expected));
  EXPECT_FALSE(zScoresAreNormal(scores));
}

TEST(Statistics, ATestWithoutResolutionFails) {
  Uniforms random(seedOfTest());
  RunningMean mean;
  for (int i = 0; i < 100; ++i) mean.add(static_cast<double>(random.next()));
  EXPECT_FALSE(agrees(mean, 0.5));
}

TEST(Statistics, ScoresOfBlocksAreNormal) {
  Uniforms random(seedOfTest());
  std::vector<double> scores;
  for (int block = 0; block < 1000; ++block) {
    RunningMean mean;
    for (int i = 0; i < 200; ++i) mean.add(static_cast<double>(random.next()));
    scores.push_back(mean.z(0.5));
  }
  EXPECT_TRUE(zScoresAreNormal(scores));
  for (double& z : scores) z *= 1.5;
  EXPECT_FALSE(zScoresAreNormal(scores));
}

TEST(Statistics, BatchMeansTameHeavyTails) {
  // 1/u² clipped: finite mean 2 - 1e-3 … the variance is dominated by rare values.
  Uniforms random(seedOfTest());
  BatchMeans batches(1000);
  for (int i = 0; i < 2000000; ++i) batches.add(1 / std::sqrt(static_cast<double>(random.next()) + 1e-4));
  EXPECT_EQ(batches.means().count(), 2000u);
  EXPECT_TRUE(agrees(batches.means(), 2 * (std::sqrt(1.0001) - 0.01)));
}

TEST(Statistics, QuadratureIsExactForPolynomials) {
  EXPECT_NEAR(integrate([](double x) { return std::pow(x, 9); }, -1, 2, 1), (1024 - 1) / 10.0, 1e-11);
  EXPECT_NEAR(integrate([](double x) { return std::exp(x); }, 0, 1, 10), std::exp(1.0) - 1, 1e-14);
}

}  // namespace
}  // namespace aerosol::test

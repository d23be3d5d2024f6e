#include <gtest/gtest.h>

#include "tests/statistical/tracker_cases.h"

// Null scattering under bounds that are tight, loose, wrong or zero; ray marching's bias.

namespace aerosol::test {
namespace {

using volume::TrackerStatistics;

Color ratioTracking(TrackerSetup& setup, Uniforms& random) {
  return setup.evaluator().finish(volume::ratioTracking(setup.evaluator(), setup.ray(), setup.span(0), random));
}

/// A smooth hump with nothing around it; the mean of its square over its maximum is what variance is made of.
TrackerCase hump(float albedo = 1) {
  const auto density = [](double t) { return 1.5 * std::pow(std::sin(3.14159265358979 * t), 2); };
  return {.name = "hump", .t0 = 0, .t1 = 1, .media = {profile(density, 1.5, Color(1.0f), Color(albedo))}};
}

/// Working bounds as parts of the true maximum.
class WorkingBound : public ::testing::TestWithParam<double> {};

TEST_P(WorkingBound, RatioTrackingHasTheRightMeanAndVariance) {
  const TrackerCase c = hump();
  const Reference reference(c);
  TrackerSetup setup(c, GetParam());
  const auto bound = static_cast<double>(setup.medium(0).bound->value);
  Uniforms random(seedOfTest());
  RunningMean mean, square;
  double largest = 0;
  for (int i = 0; i < 600000; ++i) {
    const auto value = static_cast<double>(ratioTracking(setup, random).g);
    mean.add(value);
    square.add(value * value);
    largest = std::max(largest, std::fabs(value));
  }
  EXPECT_TRUE(agrees(mean, reference.transmittance(1, 1)));
  // E[T²] = exp(∫ (1 - σ/μ̄)² μ̄ - μ̄ dt); Russian roulette below 0.05 adds next to nothing.
  const double exponent = integrate(
      [&](double t) {
        const double sigma = reference.sigmaT(t, 1);
        return (1 - sigma / bound) * (1 - sigma / bound) * bound - bound;
      },
      0, 1, 200);
  EXPECT_NEAR(square.mean(), std::exp(exponent), 0.01 * std::exp(exponent));
  // Down to half of the maximum no factor is larger than 1 in size, and neither is their product.
  if (GetParam() >= 0.5) EXPECT_LE(largest, 1 + 1e-5);
  if (GetParam() < 0.5) EXPECT_GT(largest, 1.5) << "the bound is the reason";
}

TEST_P(WorkingBound, NullScatteringHasTheRightMeans) {
  const TrackerCase c = hump(0.9f);
  const Reference reference(c);
  TrackerSetup setup(c, GetParam());
  Uniforms random(seedOfTest());
  RunningMean passed, scattered;
  for (int i = 0; i < 1200000; ++i) {
    const DistanceSample s = sampleDistance(Tracker::nullScattering, setup, c, random);
    const auto weight = static_cast<double>(s.weight.g);
    passed.add(s.event == DistanceEvent::passed ? weight : 0);
    scattered.add(s.event == DistanceEvent::scattered ? weight : 0);
  }
  EXPECT_TRUE(agrees(passed, reference.transmittance(1, 1)));
  EXPECT_TRUE(agrees(scattered, reference.scattered(1)));
  // The second moment where nothing exceeds the bound is at most the mean: weights are at most 1.
  const double growth = GetParam() >= 1 ? 1 : GetParam() >= 0.75 ? 1.3 : 3;
  EXPECT_LE(scattered.variance() + std::pow(scattered.mean(), 2), growth);
  EXPECT_LE(passed.variance() + std::pow(passed.mean(), 2), growth);
}

TEST_P(WorkingBound, ViolationsAreCountedWithTheirRatio) {
  const TrackerCase c = hump();
  TrackerSetup setup(c, GetParam());
  Uniforms random(seedOfTest());
  std::vector<DensityEvaluator::Question> questions;
  setup.evaluator().recordInto(&questions);
  for (int i = 0; i < 20000; ++i) {
    sampleDistance(Tracker::nullScattering, setup, c, random);
    ratioTracking(setup, random);
  }
  const float bound = setup.medium(0).bound->value;
  std::uint64_t violations = 0;
  float largest = 0;
  for (const DensityEvaluator::Question& question : questions) {
    violations += question.answer.sigmaT.g > bound * 1.00001f;
    largest = std::max(largest, question.answer.sigmaT.g);
  }
  const TrackerStatistics& statistics = setup.evaluator().trackerStatistics();
  EXPECT_EQ(statistics.boundViolations, violations);
  EXPECT_EQ(violations > 0, GetParam() < 1);
  if (violations == 0) return;
  EXPECT_FLOAT_EQ(statistics.worstViolation, largest / bound);
  EXPECT_NEAR(static_cast<double>(statistics.worstViolation), 1 / GetParam(), 0.01 / GetParam());
  EXPECT_EQ(statistics.worstMedium, setup.medium(0).index);
}

INSTANTIATE_TEST_SUITE_P(PartsOfTheMaximum, WorkingBound, ::testing::Values(2.0, 1.0, 0.75, 0.5, 0.4),
                         [](const auto& info) {
                           return "percent" + std::to_string(static_cast<int>(info.param * 100));
                         });

TEST(Bounds, TheWorstOfSeveralMediaIsNamed) {
  const TrackerCase c{.name = "",
                      .t0 = 0,
                      .t1 = 1,
                      .media = {profile([](double) { return 2.0; }, 1.9, Color(1.0f), Color(1.0f)),
                                profile([](double) { return 3.0; }, 1.5, Color(1.0f), Color(1.0f)),
                                profile([](double) { return 9.0; }, 9, Color(1.0f), Color(1.0f))}};
  TrackerSetup setup(c);
  Uniforms random(seedOfTest());
  std::vector<DensityEvaluator::Question> questions;
  setup.evaluator().recordInto(&questions);
  for (int i = 0; i < 300; ++i) sampleDistance(Tracker::nullScattering, setup, c, random);
  const auto asked =
      static_cast<std::uint64_t>(std::ranges::count_if(questions, [](const auto& q) { return q.medium < 2; }));
  const TrackerStatistics& statistics = setup.evaluator().trackerStatistics();
  EXPECT_EQ(statistics.worstMedium, 1u);
  EXPECT_NEAR(statistics.worstViolation, 2, 1e-4);
  EXPECT_GT(asked, 50u);
  EXPECT_EQ(statistics.boundViolations, asked) << "two media exceed their bounds at every point";
}

/// A region under a bound of 0 that is not empty: the step size says how often to look, and the means are right.
TEST(Bounds, ABoundOfZeroIsNotBelieved) {
  const auto density = [](double t) { return 0.5 + t; };
  const TrackerCase c{.name = "",
                      .t0 = 0,
                      .t1 = 1,
                      .media = {profile(density, 0, Color(1.0f), Color(0.8f), [](double) { return 1.0; })},
                      .sharpness = 4};
  const Reference reference(c);
  TrackerSetup setup(c);
  ASSERT_EQ(setup.medium(0).bound->value, 0);
  Uniforms random(seedOfTest());
  RunningMean transmittance, passed, scattered, emission;
  for (int i = 0; i < 600000; ++i) {
    transmittance.add(static_cast<double>(ratioTracking(setup, random).g));
    const DistanceSample s = sampleDistance(Tracker::nullScattering, setup, c, random);
    passed.add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight.g) : 0);
    scattered.add(s.event == DistanceEvent::scattered ? static_cast<double>(s.weight.g) : 0);
    emission.add(static_cast<double>(s.emission.g));
  }
  EXPECT_TRUE(agrees(transmittance, reference.transmittance(1, 1)));
  EXPECT_TRUE(agrees(passed, reference.transmittance(1, 1)));
  EXPECT_TRUE(agrees(scattered, reference.scattered(1)));
  EXPECT_TRUE(agrees(emission, reference.emitted(1)));
}

TEST(Bounds, AnEmptyRegionUnderABoundOfZeroIsPassed) {
  const TrackerCase c{
      .name = "", .t0 = 0, .t1 = 1, .media = {profile([](double) { return 0.0; }, 0, Color(1), Color(1))}};
  TrackerSetup setup(c);
  Uniforms random(seedOfTest());
  for (int i = 0; i < 1000; ++i) {
    const DistanceSample s = sampleDistance(Tracker::nullScattering, setup, c, random);
    ASSERT_EQ(s.event, DistanceEvent::passed);
    ASSERT_EQ(s.weight, Color(1.0f));
    ASSERT_EQ(ratioTracking(setup, random), Color(1.0f));
  }
}

// Marching: the exact mean over the offset, by a grid of offsets instead of random ones. The error of a mean over a
// uniform offset goes with the square of the step, whatever is measured.

/// Numbers in a given order: jitter 0, the offset, then what decides the distance.
struct Scripted {
  std::array<float, 5> numbers{};
  std::size_t at = 0;
  float next() { return numbers[std::min(at++, numbers.size() - 1)]; }
};

struct MarchedMeans {
  double transmittance = 0, passed = 0, scattered = 0, firstMoment = 0, emission = 0;
};

MarchedMeans marchedMeans(const TrackerCase& c, int steps) {
  constexpr int offsets = 64, distances = 1024;
  TrackerSetup setup(c);
  const auto step = static_cast<float>((c.t1 - c.t0) / steps);
  MarchedMeans means;
  volume::MarchingTable table;
  for (int o = 0; o < offsets; ++o) {
    const float offset = (static_cast<float>(o) + 0.5f) / offsets;
    Scripted numbers{.numbers = {0, offset}};
    means.transmittance += static_cast<double>(setup.evaluator()
                                                   .finish(volume::marchedTransmittance(setup.evaluator(), setup.ray(),
                                                                                        setup.span(0), step, numbers))
                                                   .g) /
                           offsets;
    for (int d = 0; d < distances; ++d) {
      const float u = (static_cast<float>(d) + 0.5f) / distances;
      Scripted random{.numbers = {0, offset, u, 0.5f, 0.5f}};
      const DistanceSample s = setup.evaluator().finish(
          volume::sampleByMarching(setup.evaluator(), setup.ray(), setup.segment(), step, c.throughput, random, table));
      const double weight = static_cast<double>(s.weight.g) / (offsets * distances);
      if (s.event == DistanceEvent::passed) means.passed += weight;
      if (s.event == DistanceEvent::scattered) means.scattered += weight;
      if (s.event == DistanceEvent::scattered) means.firstMoment += weight * static_cast<double>(s.t);
      means.emission += static_cast<double>(s.emission.g) / (offsets * distances);
    }
  }
  return means;
}

/// Slope of log |error| over log step.
double orderOf(std::span<const double> errors) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double x = -static_cast<double>(i) * std::log(2), y = std::log(std::fabs(errors[i]));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(MarchingBias, IsOfSecondOrder) {
  const TrackerCase c{.name = "",
                      .t0 = 0,
                      .t1 = 1,
                      .media = {profile([](double t) { return 0.5 + 3 * t * t; }, 3.5, Color(1.0f), Color(0.8f),
                                        [](double t) { return 1 + 2 * t; })}};
  const Reference reference(c);
  const double transmittance = reference.transmittance(1, 1), scattered = reference.scattered(1);
  const double firstMoment = reference.integral([&](double t, int k) { return t * reference.sigmaS(t, k); }, 1);
  std::array<std::vector<double>, 5> errors;
  for (const int steps : {2, 4, 8, 16}) {
    const MarchedMeans means = marchedMeans(c, steps);
    errors[0].push_back(means.transmittance - transmittance);
    errors[1].push_back(means.passed - transmittance);
    errors[2].push_back(means.scattered - scattered);
    errors[3].push_back(means.firstMoment - firstMoment);
    errors[4].push_back(means.emission - reference.emitted(1));
  }
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_GT(orderOf(errors[i]), 1.7) << i << ": " << ::testing::PrintToString(errors[i]);
    EXPECT_LT(orderOf(errors[i]), 2.4) << i << ": " << ::testing::PrintToString(errors[i]);
  }
  // E[exp(-τ̂)] - T = T Var(τ̂) / 2 with Var(τ̂) = h² Δσ² / 12.
  const double expected = transmittance / 2 * std::pow(3.0 / 16, 2) / 12;
  EXPECT_NEAR(errors[0][3], expected, 0.05 * expected);
}

/// Two combs: the variance of the depths cancels, so the bias falls faster, and is far smaller at the same cost.
TEST(MarchingBias, OfTwoCombsIsOfHigherOrder) {
  const TrackerCase c{.name = "",
                      .t0 = 0,
                      .t1 = 1,
                      .media = {profile([](double t) { return 0.5 + 6 * t * t; }, 6.5, Color(1.0f), Color())}};
  const Reference reference(c);
  TrackerSetup setup(c);
  const auto biasOf = [&](bool two, int steps) {
    constexpr int offsets = 128;
    setup.medium(0).stepSize = static_cast<float>(1.0 / steps);
    double mean = 0;
    for (int i = 0; i < offsets; ++i) {
      for (int j = 0; j < (two ? offsets : 1); ++j) {
        const auto place = [](int k) { return (static_cast<float>(k) + 0.5f) / offsets; };
        Scripted numbers{.numbers = {0, place(i), place(j)}};
        const auto method = two ? volume::TransmittanceMethod::twoCombs : volume::TransmittanceMethod::marching;
        mean += static_cast<double>(setup.evaluator()
                                        .finish(volume::estimateTransmittance(method, setup.evaluator(), setup.ray(),
                                                                              setup.span(0), numbers))
                                        .g) /
                (offsets * (two ? offsets : 1));
      }
    }
    return mean - reference.transmittance(1, 1);
  };
  std::vector<double> errors;
  for (const int steps : {4, 8, 16}) errors.push_back(biasOf(true, steps));
  EXPECT_GT(orderOf(errors), 3) << ::testing::PrintToString(errors);
  EXPECT_LT(std::fabs(errors[1]), 0.3 * std::fabs(biasOf(false, 8)));
}

TEST(MarchingBias, AConstantHasNone) {
  const TrackerCase c = findCase("constant");
  for (const int steps : {1, 3}) {
    const MarchedMeans means = marchedMeans(c, steps);
    const Reference reference(c);
    EXPECT_NEAR(means.transmittance, reference.transmittance(c.t1, 1), 1e-6);
    EXPECT_NEAR(means.passed, reference.transmittance(c.t1, 1), 1e-3);
    EXPECT_NEAR(means.scattered, reference.scattered(1), 1e-3);
  }
}

/// The number of cells is rounded at random with the right mean, so that no bias comes from it.
TEST(MarchingCellsTest, CountIsJittered) {
  Uniforms random(seedOfTest());
  RunningMean count;
  for (int i = 0; i < 100000; ++i) {
    const volume::MarchingCells cells(1, 1 / 3.3f, random.next(), 0.5f);
    count.add(cells.count);
    ASSERT_TRUE(cells.count == 3 || cells.count == 4);
    ASSERT_FLOAT_EQ(cells.step * static_cast<float>(cells.count), 1);
  }
  EXPECT_TRUE(agrees(count, 3.3));
}

}  // namespace
}  // namespace aerosol::test

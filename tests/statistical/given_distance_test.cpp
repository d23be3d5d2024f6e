#include <gtest/gtest.h>

#include "tests/statistical/tracker_cases.h"

// Distances that something else than the tracker chose: what trackers find there against quadrature, and the sum of
// both techniques under the balance heuristic, which is right for any chain of collisions and any table only if both
// sides agree on the densities of the same thing.

namespace aerosol::test {
namespace {

using volume::GivenDistance;

/// A tracker's own sample and what lies at a given distance, on one way through the segment.
template <class Random>
DistanceSample sampleWithGiven(Tracker tracker, TrackerSetup& setup, const TrackerCase& c, Random& random,
                               GivenDistance& given, bool tracks = true) {
  static volume::MarchingTable table;
  switch (tracker) {
    case Tracker::closedForm: {
      const volume::HomogeneousSegment segment(setup.segment(), c.throughput);
      const DistanceSample sample = tracks ? segment.sample(random) : DistanceSample{};
      segment.find(given, random);
      return sample;
    }
    case Tracker::marching: {
      const auto step = static_cast<float>((c.t1 - c.t0) / c.steps);
      return setup.evaluator().finish(volume::sampleByMarching(setup.evaluator(), setup.ray(), setup.segment(), step,
                                                               c.throughput, random, table, &given, tracks));
    }
    default:
      return sampleCollision(tracker, setup.evaluator(), setup.ray(), setup.segment(), c.throughput, random, &given,
                             tracks);
  }
}

using TrackerAndCase = std::tuple<Tracker, TrackerCase>;

std::vector<TrackerAndCase> trackersAndCases() {
  std::vector<TrackerAndCase> all;
  for (const Tracker tracker : allTrackers) {
    for (const TrackerCase& c : trackerCases()) {
      if (serves(tracker, c) && c.name != "dense" && c.name != "denseLinear") all.emplace_back(tracker, c);
    }
  }
  return all;
}

class GivenDistances : public ::testing::TestWithParam<TrackerAndCase> {
 protected:
  Tracker tracker() const { return std::get<0>(GetParam()); }
  const TrackerCase& trackerCase() const { return std::get<1>(GetParam()); }
};

constexpr int rounds = 150, roundSize = 20000;

/// A value below this is tested absolutely.
constexpr double negligible = 2e-3;

bool isResolved(const RunningMean& mean, double expected) {
  return std::fabs(expected) < negligible || mean.standardError() < 0.9 * meanResolution * std::fabs(expected);
}

::testing::AssertionResult meets(const RunningMean& mean, double expected) {
  if (std::fabs(expected) >= negligible) return agrees(mean, expected);
  if (std::fabs(mean.mean() - expected) <= maximumZ * mean.standardError() + 1e-6) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << mean.mean() << " for " << expected;
}

/// With t uniform in the segment, weight · length is an estimate of ∫ σs T.
TEST_P(GivenDistances, WhatIsFoundMeetsQuadrature) {
  const TrackerCase& c = trackerCase();
  const Reference reference(c);
  TrackerSetup setup(c);
  prepare(tracker(), setup, c);
  Uniforms random(seedOfTest());
  std::array<RunningMean, 3> means;
  std::array<double, 3> expected{};
  for (const int k : channels) expected[static_cast<std::size_t>(k)] = reference.scattered(k);
  for (int r = 0; r < rounds; ++r) {
    for (int i = 0; i < roundSize; ++i) {
      const auto u = (static_cast<double>(i) + static_cast<double>(random.next())) / roundSize;
      GivenDistance given{.t = std::min(c.t0 + u * (c.t1 - c.t0), std::nextafter(c.t1, c.t0))};
      sampleWithGiven(tracker(), setup, c, random, given, i % 2 == 0);
      const bool isFound = given.sample.event == DistanceEvent::scattered;
      if (isFound) ASSERT_EQ(given.sample.t, given.t);
      for (const int k : channels) {
        const float weight = isFound && c.throughput[k] != 0 ? given.sample.weight[k] : 0;
        ASSERT_TRUE(std::isfinite(weight));
        means[static_cast<std::size_t>(k)].add(static_cast<double>(weight) * (c.t1 - c.t0));
      }
    }
    bool isEnough = true;
    for (const int k : channels) {
      const auto i = static_cast<std::size_t>(k);
      isEnough = isEnough && (c.throughput[k] == 0 || isResolved(means[i], expected[i]));
    }
    if (isEnough) break;
  }
  for (const int k : channels) {
    if (c.throughput[k] == 0) continue;
    EXPECT_TRUE(meets(means[static_cast<std::size_t>(k)], expected[static_cast<std::size_t>(k)])) << "channel " << k;
  }
}

/// ∫ f σs T for an f with a peak, by the tracker's distances and given ones with a density of their own together.
::testing::AssertionResult bothTogetherAreRight(Tracker tracker, const TrackerCase& c, double fault) {
  const Reference reference(c);
  TrackerSetup setup(c);
  prepare(tracker, setup, c);
  Uniforms random(seedOfTest());
  const double length = c.t1 - c.t0;
  const auto f = [&](double t) { return 0.3 + 3 * std::exp(-std::pow((t - c.t0 - 0.4 * length) / (0.2 * length), 2)); };
  // Given distances lie in the first two thirds, twice as often in the first one.
  const auto density = [&](double t) {
    const double place = (t - c.t0) / length;
    return (place < 1.0 / 3 ? 2.0 : place < 2.0 / 3 ? 1.0 : 0.0) / length;
  };
  std::array<RunningMean, 3> means;
  std::array<double, 3> expected{};
  for (const int k : channels) {
    expected[static_cast<std::size_t>(k)] =
        reference.integral([&](double t, int i) { return f(t) * reference.sigmaS(t, i); }, k);
  }
  for (int r = 0; r < rounds; ++r) {
    for (int i = 0; i < roundSize; ++i) {
      const auto u = static_cast<double>(random.next());
      GivenDistance given{.t = c.t0 + length / 3 * (u < 2.0 / 3 ? 1.5 * u : 3 * u - 1)};
      const DistanceSample own = sampleWithGiven(tracker, setup, c, random, given);
      std::array<double, 3> value{};
      if (own.event == DistanceEvent::scattered) {
        const double share = own.choicePdf / (own.choicePdf + density(own.t));
        for (const int k : channels)
          value[static_cast<std::size_t>(k)] += static_cast<double>(own.weight[k]) * share * f(own.t);
      }
      if (given.sample.event == DistanceEvent::scattered) {
        const double sum = given.sample.choicePdf * fault + density(given.t);
        for (const int k : channels)
          value[static_cast<std::size_t>(k)] += static_cast<double>(given.sample.weight[k]) / sum * f(given.t);
      }
      for (const int k : channels) {
        const auto n = static_cast<std::size_t>(k);
        means[n].add(c.throughput[k] != 0 ? value[n] : 0);
      }
    }
    bool isEnough = true;
    for (const int k : channels) {
      const auto i = static_cast<std::size_t>(k);
      isEnough = isEnough && (c.throughput[k] == 0 || isResolved(means[i], expected[i]));
    }
    if (isEnough) break;
  }
  for (const int k : channels) {
    if (c.throughput[k] == 0) continue;
    if (auto result = meets(means[static_cast<std::size_t>(k)], expected[static_cast<std::size_t>(k)]); !result) {
      return result << " in channel " << k;
    }
  }
  return ::testing::AssertionSuccess();
}

TEST_P(GivenDistances, BothTechniquesTogetherMeetQuadrature) {
  EXPECT_TRUE(bothTogetherAreRight(tracker(), trackerCase(), 1));
}

INSTANTIATE_TEST_SUITE_P(All, GivenDistances, ::testing::ValuesIn(trackersAndCases()), [](const auto& info) {
  return std::string(name(std::get<0>(info.param))) + "_" + std::get<1>(info.param).name;
});

/// A density that is 6% off on one side alone moves a mean by about a third of that.
TEST(GivenDistanceSelfTest, WrongDensitiesAreCaught) {
  for (const Tracker tracker : allTrackers) {
    EXPECT_FALSE(bothTogetherAreRight(tracker, findCase("constantChromatic"), 1.06)) << tracker;
  }
}

}  // namespace
}  // namespace aerosol::test

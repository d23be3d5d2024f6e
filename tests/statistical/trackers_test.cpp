#include <gtest/gtest.h>

#include <functional>

#include "tests/statistical/tracker_cases.h"

// Every tracker on every density: means of all that it returns against quadrature, distances against the density that
// it claims, and that a fault of 2% in any part is found.

namespace aerosol::test {
namespace {

/// All estimates that a distance sampler makes, as they come in.
class DistanceEstimates {
 public:
  explicit DistanceEstimates(const TrackerCase& c) : case_(c) {}

  void add(const DistanceSample& sample) {
    const bool isScattered = sample.event == DistanceEvent::scattered;
    const bool isPassed = sample.event == DistanceEvent::passed;
    isSound_ = isSound_ && isFinite(sample.weight) && isFinite(sample.emission);
    for (const int c : channels) {
      const auto i = static_cast<std::size_t>(c);
      // Channels without throughput are not sampled for: their weights are never used.
      const double weight = usedChannel(c) ? static_cast<double>(sample.weight[c]) : 0;
      passed_[i].add(isPassed ? weight : 0);
      scattered_[i].add(isScattered ? weight : 0);
      emission_[i].add(usedChannel(c) ? static_cast<double>(sample.emission[c]) : 0);
    }
    const std::size_t bin = isScattered ? binOf(static_cast<double>(sample.t)) : bins;
    for (std::size_t b = 0; b < bins; ++b) {
      binned_[b].add(b == bin ? static_cast<double>(dot(sample.weight)) : 0);
    }
    if (isScattered) {
      isInside_ = isInside_ && sample.t >= static_cast<float>(case_.t0) && sample.t <= static_cast<float>(case_.t1);
    }
  }

  bool usedChannel(int c) const { return case_.throughput[c] != 0; }
  const RunningMean& passed(int c) const { return passed_[static_cast<std::size_t>(c)]; }
  const RunningMean& scattered(int c) const { return scattered_[static_cast<std::size_t>(c)]; }
  const RunningMean& emission(int c) const { return emission_[static_cast<std::size_t>(c)]; }
  /// Of throughput · weight, averaged over the channels.
  const RunningMean& binned(std::size_t b) const { return binned_[b]; }
  bool isSound() const { return isSound_ && isInside_; }

 private:
  float dot(Color weight) const { return average(weight * case_.throughput); }
  std::size_t binOf(double t) const {
    const double place = (t - case_.t0) / (case_.t1 - case_.t0) * bins;
    return static_cast<std::size_t>(std::clamp(place, 0.0, bins - 1.0));
  }

  const TrackerCase& case_;
  std::array<RunningMean, 3> passed_, scattered_, emission_;
  std::array<RunningMean, bins> binned_;
  bool isSound_ = true, isInside_ = true;
};

/// Values below this share of what there is are tested absolutely: one in a million samples tells of them.
constexpr double negligible = 1e-3;

/// Whether more samples are needed to see 0.3% of a value.
bool isUnresolved(const RunningMean& sample, double expected) {
  return std::fabs(expected) > negligible && sample.standardError() > 0.9 * meanResolution * std::fabs(expected);
}

/// What the cells of the cases leave of marching's bias: far below the resolution, but not below the noise where there
/// is hardly any.
constexpr double marchingBias = 2e-4;

double biasOf(Tracker tracker) { return tracker == Tracker::marching ? marchingBias : 0; }

/// The mean meets its value up to a known bias and the rounding of single numbers.
bool meetsExactly(const RunningMean& sample, double expected, double bias = 0) {
  return std::fabs(sample.mean() - expected) <= std::max(bias, 1e-6) * std::fabs(expected);
}

::testing::AssertionResult meets(const RunningMean& sample, double expected, const std::string& what, double bias = 0) {
  if (meetsExactly(sample, expected, bias) && !isUnresolved(sample, expected)) return ::testing::AssertionSuccess();
  if (std::fabs(expected) > negligible) {
    ::testing::AssertionResult result = agrees(sample, expected);
    return result << " [" << what << "]";
  }
  const double slack = maximumZ * sample.standardError() + 1e-6;
  if (std::fabs(sample.mean() - expected) <= slack) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << what << ": mean " << sample.mean() << ", expected " << expected;
}

/// Runs a sampler until all its means are resolved and tests each against quadrature, and the chi-squared of the places
/// where light is scattered.
::testing::AssertionResult meansAreRight(const TrackerCase& c, const Reference& reference,
                                         const DistanceSampler& sample, double bias = 0) {
  std::array<double, 3> passed{}, scattered{}, emission{};
  for (const int k : channels) {
    const auto i = static_cast<std::size_t>(k);
    if (c.throughput[k] == 0) continue;
    passed[i] = reference.transmittance(c.t1, k);
    scattered[i] = reference.scattered(k);
    emission[i] = reference.emitted(k);
  }
  DistanceEstimates estimates(c);
  constexpr int round = 50000, maximumRounds = 60;
  for (int r = 0; r < maximumRounds; ++r) {
    for (int i = 0; i < round; ++i) estimates.add(sample());
    bool isEnough = true;
    for (const int k : channels) {
      const auto i = static_cast<std::size_t>(k);
      isEnough = isEnough && !isUnresolved(estimates.passed(k), passed[i]) &&
                 !isUnresolved(estimates.scattered(k), scattered[i]) &&
                 !isUnresolved(estimates.emission(k), emission[i]);
    }
    if (isEnough) break;
  }
  if (!estimates.isSound()) return ::testing::AssertionFailure() << "a sample is not finite or outside of the segment";
  for (const int k : channels) {
    const auto i = static_cast<std::size_t>(k);
    const std::string suffix = " in channel " + std::to_string(k);
    for (const auto& result : {meets(estimates.passed(k), passed[i], "transmittance" + suffix, bias),
                               meets(estimates.scattered(k), scattered[i], "scattering" + suffix, bias),
                               meets(estimates.emission(k), emission[i], "emission" + suffix, bias)}) {
      if (!result) return result;
    }
  }
  double statistic = 0, degrees = 0;
  for (int b = 0; b < bins; ++b) {
    double expected = 0;
    for (const int k : channels) expected += static_cast<double>(c.throughput[k]) * reference.scattered(k, b, bins) / 3;
    const RunningMean& found = estimates.binned(static_cast<std::size_t>(b));
    if (expected < negligible || meetsExactly(found, expected, bias)) continue;
    statistic += std::pow(found.z(expected), 2);
    ++degrees;
  }
  if (degrees > 0 && !(chiSquaredTail(statistic, degrees) > minimumP)) {
    return ::testing::AssertionFailure() << "places of scattering: chi-squared " << statistic << " of " << degrees;
  }
  return ::testing::AssertionSuccess();
}

using TrackerAndCase = std::tuple<Tracker, TrackerCase>;

std::vector<TrackerAndCase> trackersAndCases() {
  std::vector<TrackerAndCase> all;
  for (const Tracker tracker : allTrackers) {
    for (const TrackerCase& c : trackerCases()) {
      if (serves(tracker, c)) all.emplace_back(tracker, c);
    }
  }
  return all;
}

std::string nameOf(const ::testing::TestParamInfo<TrackerAndCase>& info) {
  return std::string(name(std::get<0>(info.param))) + "_" + std::get<1>(info.param).name;
}

class DistanceTrackers : public ::testing::TestWithParam<TrackerAndCase> {
 protected:
  Tracker tracker() const { return std::get<0>(GetParam()); }
  const TrackerCase& trackerCase() const { return std::get<1>(GetParam()); }
};

TEST_P(DistanceTrackers, MeansMeetQuadrature) {
  const TrackerCase& c = trackerCase();
  TrackerSetup setup(c);
  prepare(tracker(), setup, c);
  Uniforms random(seedOfTest());
  EXPECT_TRUE(
      meansAreRight(c, Reference(c), [&] { return sampleDistance(tracker(), setup, c, random); }, biasOf(tracker())));
  EXPECT_EQ(setup.evaluator().trackerStatistics().boundViolations, 0u);
  EXPECT_EQ(setup.evaluator().trackerStatistics().stepLimits, 0u);
}

/// A real suspension at each question changes nothing.
TEST_P(DistanceTrackers, SuspensionChangesNothing) {
  const TrackerCase& c = trackerCase();
  TrackerSetup atOnce(c), suspending(c, 1, true);
  prepare(tracker(), atOnce, c);
  prepare(tracker(), suspending, c);
  Uniforms a(seedOfTest()), b(seedOfTest());
  for (int i = 0; i < 300; ++i) {
    const DistanceSample x = sampleDistance(tracker(), atOnce, c, a), y = sampleDistance(tracker(), suspending, c, b);
    ASSERT_EQ(x.t, y.t);
    ASSERT_EQ(x.weight, y.weight);
    ASSERT_EQ(x.emission, y.emission);
    ASSERT_EQ(x.logPdf, y.logPdf);
    ASSERT_EQ(x.event, y.event);
  }
  EXPECT_TRUE(suspending.evaluator().frames().isEmpty());
  EXPECT_EQ(suspending.evaluator().frames().heapBlocks(), 0u);
}

INSTANTIATE_TEST_SUITE_P(All, DistanceTrackers, ::testing::ValuesIn(trackersAndCases()), nameOf);

// Transmittance.

using volume::TransmittanceMethod;

template <class Random>
Color estimateTransmittance(TransmittanceMethod method, TrackerSetup& setup, const TrackerCase& c, Random& random) {
  setup.medium(0).stepSize = static_cast<float>((c.t1 - c.t0) / std::min(c.steps, 1000));
  return setup.evaluator().finish(
      volume::estimateTransmittance(method, setup.evaluator(), setup.ray(), setup.span(0), random));
}

::testing::AssertionResult transmittanceIsRight(const TrackerCase& c, const Reference& reference,
                                                const std::function<Color()>& estimate, double bias = 0) {
  std::array<RunningMean, 3> means;
  constexpr int round = 20000, maximumRounds = 100;
  for (int r = 0; r < maximumRounds; ++r) {
    for (int i = 0; i < round; ++i) {
      const Color value = estimate();
      if (!isFinite(value)) return ::testing::AssertionFailure() << "not finite";
      for (const int k : channels) means[static_cast<std::size_t>(k)].add(static_cast<double>(value[k]));
    }
    if (std::none_of(channels.begin(), channels.end(), [&](int k) {
          return isUnresolved(means[static_cast<std::size_t>(k)], reference.transmittance(c.t1, k));
        }))
      break;
  }
  for (const int k : channels) {
    const auto result = meets(means[static_cast<std::size_t>(k)], reference.transmittance(c.t1, k),
                              "transmittance in channel " + std::to_string(k), bias);
    if (!result) return result;
  }
  return ::testing::AssertionSuccess();
}

std::vector<TrackerCase> singleMediumCases() {
  std::vector<TrackerCase> cases;
  for (const TrackerCase& c : trackerCases()) {
    if (c.media.size() != 1) continue;
    cases.push_back(c);
    cases.back().media[0].isConstant = false;  // Estimated as if nothing were known.
  }
  return cases;
}

using MethodAndCase = std::tuple<TransmittanceMethod, TrackerCase>;

std::vector<MethodAndCase> methodsAndCases() {
  std::vector<MethodAndCase> all;
  for (const TransmittanceMethod method : volume::allTransmittanceMethods) {
    if (method == TransmittanceMethod::analytic) continue;  // Of voxels alone: see analytic_test.cpp.
    for (TrackerCase c : singleMediumCases()) {
      if (method == TransmittanceMethod::closedForm) c.media[0].isConstant = findCase(c.name).isConstant();
      if (method != TransmittanceMethod::closedForm || c.isConstant()) all.emplace_back(method, c);
    }
  }
  return all;
}

const char* name(TransmittanceMethod method) {
  constexpr std::array names{"closedForm", "analytic",         "marching",     "ratioTracking",
                             "twoCombs",   "unbiasedMarching", "deltaTracking"};
  static_assert(names.size() == volume::allTransmittanceMethods.size());
  return names[static_cast<std::size_t>(method)];
}

class TransmittanceEstimators : public ::testing::TestWithParam<MethodAndCase> {};

TEST_P(TransmittanceEstimators, MeansMeetQuadrature) {
  const auto& [method, c] = GetParam();
  for (const bool relaxes : {false, true}) {
    if (relaxes && method != TransmittanceMethod::ratioTracking) continue;
    TrackerSetup setup(c);
    setup.medium(0).relaxesBound = relaxes;
    Uniforms random(seedOfTest(relaxes));
    // The relaxed bound is that of the case; the cells are the estimator's own.
    const auto estimate = [&] { return estimateTransmittance(method, setup, c, random); };
    EXPECT_TRUE(transmittanceIsRight(c, Reference(c), estimate, volume::isUnbiased(method) ? 0 : marchingBias));
    EXPECT_EQ(setup.evaluator().trackerStatistics().boundViolations, 0u);
    EXPECT_EQ(setup.evaluator().trackerStatistics().stepLimits, 0u);
  }
}

TEST_P(TransmittanceEstimators, SuspensionChangesNothing) {
  const auto& [method, c] = GetParam();
  TrackerSetup atOnce(c), suspending(c, 1, true);
  Uniforms a(seedOfTest()), b(seedOfTest());
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(estimateTransmittance(method, atOnce, c, a), estimateTransmittance(method, suspending, c, b));
  }
  EXPECT_TRUE(suspending.evaluator().frames().isEmpty());
  EXPECT_EQ(suspending.evaluator().frames().heapBlocks(), 0u);
}

INSTANTIATE_TEST_SUITE_P(All, TransmittanceEstimators, ::testing::ValuesIn(methodsAndCases()), [](const auto& info) {
  return std::string(name(std::get<0>(info.param))) + "_" + std::get<1>(info.param).name;
});

// Self-tests: each kind of fault, 2% large, is found by the test that is there for it.

constexpr float fault = 1.02f;

/// Flights 2% too long: those of a bound that is 2% lower than the one in the weights.
class LongFlights {
 public:
  explicit LongFlights(std::uint64_t seed) : random_(seed) {}
  float next() {
    const double u = static_cast<double>(random_.next());
    return ++calls_ % 2 == 1 ? static_cast<float>(1 - std::pow(1 - u, 1.02)) : static_cast<float>(u);
  }
  void restart() { calls_ = 0; }

 private:
  Uniforms random_;
  int calls_ = 0;
};

class TrackerSelfTest : public ::testing::TestWithParam<Tracker> {
 protected:
  TrackerSelfTest() : case_(findCase("constantChromatic")), setup_(case_), random_(seedOfTest()) {
    if (GetParam() != Tracker::closedForm) case_.media[0].isConstant = false;
    setup_.medium(0).constant.reset();
    if (GetParam() == Tracker::closedForm) setup_.medium(0).constant = case_.media[0].at(0);
    prepare(GetParam(), setup_, case_);
  }
  DistanceSample sample() { return sampleDistance(GetParam(), setup_, case_, random_); }

  TrackerCase case_;
  TrackerSetup setup_;
  Uniforms random_;
};

TEST_P(TrackerSelfTest, WithoutAFaultAllIsWell) {
  EXPECT_TRUE(meansAreRight(case_, Reference(case_), [&] { return sample(); }));
}

TEST_P(TrackerSelfTest, ScatteringWeight) {
  EXPECT_FALSE(meansAreRight(case_, Reference(case_), [&] {
    DistanceSample s = sample();
    if (s.event == DistanceEvent::scattered) s.weight *= fault;
    return s;
  }));
}

TEST_P(TrackerSelfTest, PassingWeight) {
  EXPECT_FALSE(meansAreRight(case_, Reference(case_), [&] {
    DistanceSample s = sample();
    if (s.event == DistanceEvent::passed) s.weight *= fault;
    return s;
  }));
}

TEST_P(TrackerSelfTest, Emission) {
  EXPECT_FALSE(meansAreRight(case_, Reference(case_), [&] {
    DistanceSample s = sample();
    s.emission *= fault;
    return s;
  }));
}

TEST_P(TrackerSelfTest, Extinction) {
  TrackerCase wrong = case_;
  wrong.media[0].at = [](double) { return coefficients(Color(0.3f, 0.8f, 1.6f) * fault, Color(0.9f, 0.6f, 0.3f)); };
  EXPECT_FALSE(meansAreRight(case_, Reference(wrong), [&] { return sample(); }));
}

TEST_P(TrackerSelfTest, DistancesAlone) {
  EXPECT_FALSE(meansAreRight(case_, Reference(case_), [&] {
    DistanceSample s = sample();
    if (s.event == DistanceEvent::scattered) {
      s.t = std::min(case_.t1, case_.t0 + (s.t - case_.t0) * static_cast<double>(fault));
    }
    return s;
  }));
}

INSTANTIATE_TEST_SUITE_P(All, TrackerSelfTest, ::testing::ValuesIn(allTrackers),
                         [](const auto& info) { return std::string(name(info.param)); });

TEST(TrackerSelfTest, BoundOfRatioTracking) {
  TrackerCase c = findCase("linear");
  TrackerSetup setup(c);
  LongFlights random(seedOfTest());
  EXPECT_FALSE(transmittanceIsRight(c, Reference(c), [&] {
    return setup.evaluator().finish(volume::ratioTracking(setup.evaluator(), setup.ray(), setup.span(0), random));
  }));
}

TEST(TrackerSelfTest, BoundOfNullScattering) {
  const TrackerCase c = findCase("chromatic");
  TrackerSetup setup(c);
  LongFlights random(seedOfTest());
  EXPECT_FALSE(meansAreRight(c, Reference(c), [&] {
    random.restart();
    return sampleDistance(Tracker::nullScattering, setup, c, random);
  }));
}

TEST(TrackerSelfTest, EveryTransmittanceEstimator) {
  for (const TransmittanceMethod method : volume::allTransmittanceMethods) {
    if (method == TransmittanceMethod::analytic) continue;
    TrackerCase c = findCase(method == TransmittanceMethod::closedForm ? "constant" : "linear");
    TrackerSetup setup(c);
    Uniforms random(seedOfTest());
    const auto estimate = [&] { return estimateTransmittance(method, setup, c, random); };
    EXPECT_TRUE(transmittanceIsRight(c, Reference(c), estimate, marchingBias)) << name(method);
    EXPECT_FALSE(transmittanceIsRight(c, Reference(c), [&] { return estimate() * fault; })) << name(method);
  }
}

/// The roulette's mean of any term is that of the series, order by order.
TEST(SeriesRouletteTest, WeightsMakeUpForItsEnd) {
  Uniforms random(seedOfTest());
  std::array<RunningMean, 6> terms;
  for (int i = 0; i < 4000000; ++i) {
    const volume::SeriesRoulette roulette(static_cast<double>(random.next()));
    for (int k = 0; k < 6; ++k) terms[static_cast<std::size_t>(k)].add(k <= roulette.order() ? roulette.weight(k) : 0);
  }
  for (std::size_t k = 0; k < 6; ++k) EXPECT_TRUE(agrees(terms[k], 1, 0.01)) << k;
}

}  // namespace
}  // namespace aerosol::test

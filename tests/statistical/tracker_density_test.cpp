#include <gtest/gtest.h>

#include "tests/statistical/tracker_cases.h"

// What a sample says of its density.
//
// With p the density of distances, E[1(t in B) / p(t)] = |B| for every set B that p reaches, and P(passed) = P. A joint
// density is over chains of collisions: of those that scatter at the first tentative one the same holds, and of those
// that scatter at the second the measure is that of pairs s < t.

namespace aerosol::test {
namespace {

/// Bins are resolved less well than the whole.
constexpr double binResolution = 0.012;

/// Means of 1 / p over the samples of one kind, all together and by bins of t.
class InverseDensity {
 public:
  void add(const TrackerCase& c, const DistanceSample& sample, bool counts) {
    const double place = (static_cast<double>(sample.t) - c.t0) / (c.t1 - c.t0) * bins;
    const int bin = counts ? std::clamp(static_cast<int>(place), 0, bins - 1) : bins;
    const double value = counts ? 1 / sample.pdf() : 0;
    for (int b = 0; b < bins; ++b) binned_[static_cast<std::size_t>(b)].add(b == bin ? value : 0);
    whole_.add(value);
  }
  /// `measure(b)` of each bin; bins before `first` hold too little.
  template <class Measure>
  ::testing::AssertionResult meets(Measure measure, int first = 0) const {
    double sum = 0;
    for (int b = 0; b < bins; ++b) {
      sum += measure(b);
      if (b < first) continue;
      auto result = agrees(binned_[static_cast<std::size_t>(b)], measure(b), first == 0 ? binResolution : 0.03);
      if (!result) return result << " in bin " << b;
    }
    return agrees(whole_, sum, first == 0 ? meanResolution : 0.005);
  }

 private:
  std::array<RunningMean, bins> binned_;
  RunningMean whole_;
};

::testing::AssertionResult densityIsRight(const TrackerCase& c, int sampleCount, const DistanceSampler& sample) {
  InverseDensity inverse;
  RunningMean passed;
  double passProbability = 0;
  for (int i = 0; i < sampleCount; ++i) {
    const DistanceSample s = sample();
    if (s.pdfKind != volume::PdfKind::marginal) return ::testing::AssertionFailure() << "the density is not marginal";
    const bool isPassed = s.event == DistanceEvent::passed;
    inverse.add(c, s, !isPassed);
    passed.add(isPassed);
    if (isPassed) passProbability = s.pdf();
  }
  if (auto result = agrees(passed, passProbability, 0.005); !result) return result << " passing";
  return inverse.meets([&](int) { return (c.t1 - c.t0) / bins; });
}

/// Every cell of marching is where the first two numbers put it: with these given, the density is marginal.
class FixedCells {
 public:
  FixedCells(std::uint64_t seed, float jitter, float offset) : random_(seed), first_{jitter, offset} {}
  void restart() { calls_ = 0; }
  float next() {
    const std::size_t call = calls_++;
    return call < first_.size() ? first_[call] : random_.next();
  }

 private:
  Uniforms random_;
  std::array<float, 2> first_;
  std::size_t calls_ = 0;
};

/// Cases in which distances are found all over the segment, so that each bin is resolved.
TrackerCase densityCase(const char* name, Color throughput = Color(1.0f)) {
  TrackerCase c = findCase(name);
  c.throughput = throughput;
  c.steps = 37;
  return c;
}

class DensityOfDistances : public ::testing::TestWithParam<TrackerCase> {};

TEST_P(DensityOfDistances, ClosedForm) {
  const TrackerCase& c = GetParam();
  if (!c.isConstant()) return;
  TrackerSetup setup(c);
  Uniforms random(seedOfTest());
  EXPECT_TRUE(densityIsRight(c, 600000, [&] { return sampleDistance(Tracker::closedForm, setup, c, random); }));
}

TEST_P(DensityOfDistances, Marching) {
  const TrackerCase& c = GetParam();
  TrackerSetup setup(c);
  FixedCells random(seedOfTest(), 0.5f, 0.3f);
  EXPECT_TRUE(densityIsRight(c, 600000, [&] {
    random.restart();
    return sampleDistance(Tracker::marching, setup, c, random);
  }));
}

INSTANTIATE_TEST_SUITE_P(All, DensityOfDistances,
                         ::testing::Values(densityCase("constant"), densityCase("twoConstants"),
                                           densityCase("constantChromatic"),
                                           densityCase("constantChromatic", Color(1, 0.5f, 0.1f)),
                                           densityCase("gentle"), densityCase("gentleChromatic", Color(0.5f, 1, 0.25f)),
                                           densityCase("varyingInConstant")),
                         [](const auto& info) { return info.param.name + std::to_string(info.index); });

/// The number of collisions comes from the evaluator: one question a medium and collision.
::testing::AssertionResult jointDensityIsRight(const TrackerCase& c, TrackerSetup& setup, int sampleCount,
                                               const DistanceSampler& sample) {
  InverseDensity first, second;
  for (int i = 0; i < sampleCount; ++i) {
    const std::uint64_t before = setup.evaluator().asked();
    const DistanceSample s = sample();
    if (s.pdfKind != volume::PdfKind::joint) return ::testing::AssertionFailure() << "the density is not joint";
    const std::uint64_t collisions = setup.evaluator().asked() - before;
    const bool isScattered = s.event == DistanceEvent::scattered;
    first.add(c, s, isScattered && collisions == 1);
    second.add(c, s, isScattered && collisions == 2);
  }
  const double width = (c.t1 - c.t0) / bins;
  if (auto result = first.meets([&](int) { return width; }); !result) return result << " first collision";
  auto result = second.meets([&](int b) { return width * width * (b + 0.5); }, 3);
  return result << " second collision";
}

class JointDensity : public ::testing::TestWithParam<TrackerCase> {};

TEST_P(JointDensity, NullScattering) {
  const TrackerCase& c = GetParam();
  TrackerSetup setup(c, 1.3);  // Above the maximum: every place may be a null collision and every one a real one.
  Uniforms random(seedOfTest());
  EXPECT_TRUE(jointDensityIsRight(c, setup, 2000000,
                                  [&] { return sampleDistance(Tracker::nullScattering, setup, c, random); }));
}

class ChainDensity : public ::testing::TestWithParam<TrackerCase> {};

/// The probability of a chain, computed from the points at which the tracker asked.
TEST_P(ChainDensity, IsThatOfTheChain) {
  const TrackerCase& c = GetParam();
  TrackerSetup setup(c, 1.3);
  Uniforms random(seedOfTest());
  std::vector<DensityEvaluator::Question> chain;
  setup.evaluator().recordInto(&chain);
  const auto boundOf = [&](std::size_t medium) { return static_cast<double>(setup.medium(medium).bound->value); };
  double all = 0;
  for (std::size_t i = 0; i < c.media.size(); ++i) all += boundOf(i);
  const double sum = static_cast<double>(c.throughput.r + c.throughput.g + c.throughput.b);
  for (int i = 0; i < 2000; ++i) {
    chain.clear();
    const DistanceSample s = sampleDistance(Tracker::nullScattering, setup, c, random);
    double logPdf = 0, t = c.t0;
    std::array<double, 3> weight{1, 1, 1};
    for (std::size_t k = 0; k < chain.size(); ++k) {
      const double x = static_cast<double>(chain[k].point.x);
      const double bound = boundOf(chain[k].medium);
      logPdf += std::log(bound) - all * (x - t);
      t = x;
      double scatter = 0, pass = 0;
      for (const int j : channels) {
        const auto n = static_cast<std::size_t>(j);
        const double share = static_cast<double>(c.throughput[j]) / sum * std::fabs(weight[n]);
        scatter += share * static_cast<double>(chain[k].answer.sigmaS[j]);
        pass += share * (bound - static_cast<double>(chain[k].answer.sigmaT[j]));
      }
      const bool isLast = k + 1 == chain.size() && s.event == DistanceEvent::scattered;
      const double probability = (isLast ? scatter : pass) / (scatter + pass);
      logPdf += std::log(probability);
      for (const int j : channels) {
        const auto n = static_cast<std::size_t>(j);
        const double value = isLast ? static_cast<double>(chain[k].answer.sigmaS[j])
                                    : bound - static_cast<double>(chain[k].answer.sigmaT[j]);
        weight[n] *= value / (bound * probability);
      }
    }
    if (s.event == DistanceEvent::absorbed) continue;  // Russian roulette.
    if (s.event == DistanceEvent::passed) logPdf -= all * (c.t1 - t);
    ASSERT_NEAR(s.logPdf, logPdf, 1e-4 * std::max(1.0, std::fabs(logPdf)));
    if (std::fabs(weight[1]) < static_cast<double>(volume::trackerRouletteThreshold)) continue;
    for (const int j : channels) {
      const double value = weight[static_cast<std::size_t>(j)];
      ASSERT_NEAR(static_cast<double>(s.weight[j]), value, 1e-4 * std::max(1.0, std::fabs(value)));
    }
  }
}

// (Where a channel scatters next to nothing, the inverse density has no variance that could be resolved: chromatic
// cases are tested chain by chain.)
INSTANTIATE_TEST_SUITE_P(All, JointDensity, ::testing::Values(densityCase("gentle")),
                         [](const auto& info) { return info.param.name; });
INSTANTIATE_TEST_SUITE_P(All, ChainDensity,
                         ::testing::Values(densityCase("gentle"), densityCase("gentleChromatic", Color(0.5f, 1, 0.25f)),
                                           densityCase("threeVarying")),
                         [](const auto& info) { return info.param.name; });

// A fault of 2% is found.

TEST(DensitySelfTest, MarginalDensity) {
  const TrackerCase c = densityCase("constantChromatic");
  TrackerSetup setup(c);
  Uniforms random(seedOfTest());
  const auto sampleWith = [&](double scale, bool inPassing) {
    return densityIsRight(c, 600000, [&, scale, inPassing] {
      DistanceSample s = sampleDistance(Tracker::closedForm, setup, c, random);
      if ((s.event == DistanceEvent::passed) == inPassing) s.logPdf += std::log(scale);
      return s;
    });
  };
  EXPECT_FALSE(sampleWith(1.02, false));
  EXPECT_FALSE(sampleWith(0.98, false));
  EXPECT_FALSE(sampleWith(1.02, true));
}

TEST(DensitySelfTest, JointDensity) {
  const TrackerCase c = densityCase("gentle");
  TrackerSetup setup(c, 1.3);
  Uniforms random(seedOfTest());
  EXPECT_FALSE(jointDensityIsRight(c, setup, 2000000, [&] {
    DistanceSample s = sampleDistance(Tracker::nullScattering, setup, c, random);
    s.logPdf += std::log(1.02);
    return s;
  }));
}

}  // namespace
}  // namespace aerosol::test

#include <gtest/gtest.h>

#include <cmath>

#include "core/volume/trackers/analytic.h"
#include "tests/statistical/tracker_cases.h"

// Closed forms for voxels: what the tracker returns against quadrature over the field, its distances against the
// density that it claims, both kernels, one channel and three.

namespace aerosol::test {
namespace {

using volume::AnalyticSegment;
using volume::FieldRay;
using volume::GivenDistance;
using volume::VoxelField;
using volume::VoxelKernel;
using volume::VoxelMedium;

struct AnalyticCase {
  const char* name;
  VoxelKernel kernel;
  Color sigmaT, albedo, emission;
};

std::ostream& operator<<(std::ostream& out, const AnalyticCase& c) { return out << c.name; }

/// Voxels along a slanted ray, with a gap.
class AnalyticTracker : public ::testing::TestWithParam<AnalyticCase> {
 protected:
  AnalyticTracker() {
    std::vector<float> values;
    Uniforms random(seedOfTest(1));
    for (int i = 0; i < 6 * 5 * 4; ++i) values.push_back(i % 7 == 0 ? 0.0f : 2 * random.next());
    field_ = std::make_shared<const VoxelField>(VoxelField::ofValues({0, 0, 0}, {6, 5, 4}, values, GetParam().kernel));
    voxels_ = {field_, coefficients(GetParam().sigmaT, GetParam().albedo, GetParam().emission), identityMatrix(), {}};
    medium_.voxels = &voxels_;
    ray_.origin = {-1, 0.5f, 0.25f};
    ray_.direction = {0.8f, 0.48f, 0.36f};
    pointers_ = {&medium_};
    segment_ = {0.5, 7, pointers_};
    fieldRay_ = voxels_.seenFrom(medium_, ray_);
  }

  double value(double t) const { return valueAt(*field_, fieldRay_, t); }
  /// ∫ f over a part of the segment, which is fine beside the cells.
  template <class Function>
  double integral(Function f, double a, double b) const {
    return test::integrate(f, a, b, 2000);
  }
  double depth(double t) const { return volume::integrate(*field_, fieldRay_, segment_.t0, t); }
  double through(double t, int c) const { return std::exp(-static_cast<double>(GetParam().sigmaT[c]) * depth(t)); }

  std::shared_ptr<const VoxelField> field_;
  VoxelMedium voxels_;
  Medium medium_;
  std::vector<const Medium*> pointers_;
  volume::Segment segment_;
  Ray<World> ray_;
  FieldRay fieldRay_;
};

TEST_P(AnalyticTracker, DepthMeetsQuadrature) {
  const double expected = integral([&](double t) { return value(t); }, segment_.t0, segment_.t1);
  EXPECT_NEAR(depth(segment_.t1), expected, 1e-3 * expected);  // The constant kernel jumps.
  EXPECT_GT(expected, 1);
}

TEST_P(AnalyticTracker, MeansMeetQuadrature) {
  const Color throughput(1, 0.7f, 0.4f);
  std::array<RunningMean, 3> passed, scattered;
  std::array<std::array<RunningMean, bins>, 3> binned;
  Uniforms random(seedOfTest());
  const AnalyticSegment tracker(segment_, ray_, throughput);
  Color emission;
  for (int i = 0; i < 400000; ++i) {
    const DistanceSample s = tracker.sample(random);
    emission = s.emission;
    const bool isScattered = s.event == DistanceEvent::scattered, isPassed = s.event == DistanceEvent::passed;
    const auto bin = isScattered ? static_cast<std::size_t>(std::clamp(
                                       (s.t - segment_.t0) / (segment_.t1 - segment_.t0) * bins, 0.0, bins - 1.0))
                                 : bins;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto weight = static_cast<double>(s.weight[static_cast<int>(c)]);
      passed[c].add(isPassed ? weight : 0);
      scattered[c].add(isScattered ? weight : 0);
      for (std::size_t b = 0; b < bins; ++b) binned[c][b].add(b == bin ? weight : 0);
    }
  }
  std::vector<double> scores;
  for (const int c : channels) {
    const auto i = static_cast<std::size_t>(c);
    EXPECT_TRUE(agrees(passed[i], through(segment_.t1, c), 0.02)) << c;
    const double albedo = static_cast<double>(GetParam().albedo[c]);
    EXPECT_TRUE(agrees(scattered[i], albedo * (1 - through(segment_.t1, c)), 0.02)) << c;
    // ∫ ε f exp(-σ D) dt = ε (1 - exp(-σ D)) / σ.
    const double glow = static_cast<double>(GetParam().emission[c]) / static_cast<double>(GetParam().sigmaT[c]);
    EXPECT_NEAR(static_cast<double>(emission[c]), glow * (1 - through(segment_.t1, c)), 1e-5 * (1 + glow));
    for (std::size_t b = 0; b < bins; ++b) {
      const double width = (segment_.t1 - segment_.t0) / static_cast<double>(bins);
      const double a = segment_.t0 + width * static_cast<double>(b);
      const double expected = albedo * (through(a, c) - through(a + width, c));
      if (expected > 1e-3) scores.push_back(binned[i][b].z(expected));
    }
  }
  for (const double z : scores) EXPECT_LE(std::fabs(z), 5);
  EXPECT_GT(scores.size(), 9u);
}

TEST_P(AnalyticTracker, DistancesHaveTheirDensity) {
  const AnalyticSegment tracker(segment_, ray_, Color(1.0f));
  Uniforms random(seedOfTest());
  constexpr int count = 200000;
  constexpr std::size_t parts = 64;
  std::vector<double> observed(parts + 1), expected(parts + 1);
  for (int i = 0; i < count; ++i) {
    const DistanceSample s = tracker.sample(random);
    const double place = (s.t - segment_.t0) / (segment_.t1 - segment_.t0) * static_cast<double>(parts);
    ++observed[s.event == DistanceEvent::scattered ? std::min(static_cast<std::size_t>(place), parts - 1) : parts];
    if (s.event == DistanceEvent::passed) continue;
    // The density that it tells of the place is that of the field there.
    double density = 0;
    for (const int c : channels) density += static_cast<double>(GetParam().sigmaT[c]) * through(s.t, c) / 3;
    if (i < 200) EXPECT_NEAR(s.choicePdf, density * value(s.t), 1e-4 * (1 + density));
  }
  for (std::size_t b = 0; b <= parts; ++b) {
    const double width = (segment_.t1 - segment_.t0) / static_cast<double>(parts);
    const double a = segment_.t0 + width * static_cast<double>(b);
    for (const int c : channels) {
      const double part = b < parts ? through(a, c) - through(a + width, c) : through(segment_.t1, c);
      expected[b] += count * part / 3;
    }
  }
  EXPECT_TRUE(countsAgree(observed, expected));
}

TEST_P(AnalyticTracker, GivenDistancesAreWeightedAsTheyAre) {
  const AnalyticSegment tracker(segment_, ray_, Color(1.0f));
  Uniforms random(seedOfTest());
  for (int i = 0; i < 200; ++i) {
    const double t = segment_.t0 + (segment_.t1 - segment_.t0 + 2) * static_cast<double>(random.next());
    GivenDistance given{.t = t};
    tracker.find(given, random);
    double mixed = 0;
    for (const int c : channels) {
      const double transmittance = through(std::min(t, segment_.t1), c);
      const double sigma = static_cast<double>(GetParam().sigmaT[c]);
      const bool isIn = t < segment_.t1;
      mixed += (isIn ? sigma * value(t) * transmittance : transmittance) / 3;
      const double weight =
          isIn ? sigma * static_cast<double>(GetParam().albedo[c]) * value(t) * transmittance : transmittance;
      EXPECT_NEAR(static_cast<double>(given.sample.weight[c]), weight, 1e-5 * (1 + weight));
    }
    if (given.sample.event != DistanceEvent::absorbed) EXPECT_NEAR(given.sample.choicePdf, mixed, 1e-5 * (1 + mixed));
  }
}

TEST_P(AnalyticTracker, TransmittanceIsExact) {
  DensityEvaluator evaluator([](const Medium&, Point<World>) { return Coefficients(); });
  const Color t = evaluator.finish(
      volume::analyticTransmittance(evaluator, ray_, volume::MediumSpan{segment_.t0, segment_.t1, &medium_}));
  for (const int c : channels) EXPECT_NEAR(static_cast<double>(t[c]), through(segment_.t1, c), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, AnalyticTracker,
    ::testing::Values(
        AnalyticCase{"grey", VoxelKernel::trilinear, Color(0.4f), Color(0.8f), Color()},
        AnalyticCase{"chromatic", VoxelKernel::trilinear, {0.2f, 0.5f, 0.9f}, {0.9f, 0.6f, 0.3f}, {1, 2, 3}},
        AnalyticCase{"constantKernel", VoxelKernel::constant, {0.2f, 0.5f, 0.9f}, Color(0.7f), {1, 2, 3}}),
    [](const auto& info) { return info.param.name; });

/// A planted fault: a field that is 2% denser than the one that the weights are tested against.
TEST(AnalyticSelfTest, ADenserFieldIsNoticed) {
  const std::vector<float> values(4 * 4 * 4, 1.02f);
  const VoxelMedium voxels{
      std::make_shared<const VoxelField>(VoxelField::ofValues({0, 0, 0}, {4, 4, 4}, values, VoxelKernel::trilinear)),
      coefficients(Color(1.0f), Color(1.0f)),
      identityMatrix(),
      {}};
  Medium medium;
  medium.voxels = &voxels;
  const std::vector<const Medium*> pointers{&medium};
  const volume::Segment segment{0.25, 2.5, pointers};
  Ray<World> ray;
  ray.origin = {0, 1.5f, 1.5f};
  ray.direction = {1, 0, 0};
  Uniforms random(seedOfTest());
  RunningMean passed;
  for (int i = 0; i < 1000000; ++i) {
    passed.add(AnalyticSegment(segment, ray, Color(1.0f)).sample(random).event == DistanceEvent::passed ? 1 : 0);
  }
  EXPECT_FALSE(agrees(passed, std::exp(-2.25)));
  EXPECT_TRUE(agrees(passed, std::exp(-2.25 * 1.02)));
}

}  // namespace
}  // namespace aerosol::test

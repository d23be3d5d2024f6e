#include <gtest/gtest.h>

#include "tests/statistical/tracker_cases.h"

// Trackers under bounds that differ from place to place: trees built from what is truly known of a density, with
// working bounds at parts of each leaf's maximum.

namespace aerosol::test {
namespace {

using volume::BoundNode;
using volume::BoundTree;
using volume::LeafKind;
using volume::Provenance;

/// Empty, constant, and varying stretches with a bump and a glow, along x in [0, 4].
double densityAt(double x) {
  if (x < 1) return 0;
  if (x < 2) return 1.5;
  return 1.2 + std::sin(3 * x) + 2 * std::exp(-std::pow((x - 3.1) / 0.1, 2));
}
double glowAt(double x) { return x < 2 ? 0.0 : 1 + std::cos(x); }

TrackerCase pieces(double t0, double t1) {
  return {.name = "pieces",
          .t0 = t0,
          .t1 = t1,
          .media = {profile(densityAt, 5, Color(0.4f, 0.32f, 0.16f), Color(0.9f, 0.8f, 0.95f), glowAt)}};
}

/// A tree of slabs across x: 4 or 16 a side. What a leaf knows is found by looking closely; its working bound is `part`
/// of the way from 0 to its maximum, its control its minimum where weights allow it.
std::unique_ptr<BoundTree> treeOf(const TrackerCase& c, double part, bool isFine) {
  auto tree = std::make_unique<BoundTree>();
  tree->domain = {{0, -1, -1}, {4, 1, 1}};
  tree->levels = isFine ? 2 : 1;
  const auto leaf = [&](double low, double high) -> BoundNode {
    double least = 1e30, most = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double x = std::clamp(low + (high - low) * i / 1000, low + 1e-9, high - 1e-9);
      const Coefficients at = c.media[0].at(x);
      least = std::min(least, static_cast<double>(minimum(at.sigmaT)));
      most = std::max(most, static_cast<double>(maximum(at.sigmaT)));
    }
    const Coefficients middle = c.media[0].at(0.5 * (low + high));
    if (most == 0) return {0, 0, 0, BoundNode::makeLink(LeafKind::empty, Provenance::proven, 0)};
    if (high <= 2) {
      tree->uniform = {middle};
      return {maximum(middle.sigmaT), minimum(middle.sigmaT), maximum(middle.sigmaT),
              BoundNode::makeLink(LeafKind::uniform, Provenance::proven, 0)};
    }
    const double limit = most * 1.0001, working = part * limit;
    const double control = std::clamp(std::min(least * 0.9999, 2 * working - limit), 0.0, 0.99 * working);
    return {static_cast<float>(working), static_cast<float>(control), static_cast<float>(limit),
            BoundNode::makeLink(LeafKind::bounded, Provenance::proven, 0)};
  };
  tree->nodes.resize(BoundTree::parts);
  for (std::uint32_t i = 0; i < 4; ++i) {
    BoundNode node = leaf(i, i + 1);
    if (isFine && i == 3) {
      const auto first = static_cast<std::uint32_t>(tree->nodes.size());
      tree->nodes.resize(first + BoundTree::parts);
      for (std::uint32_t k = 0; k < BoundTree::parts; ++k) {
        tree->nodes[first + k] = leaf(i + 0.25 * (k & 3u), i + 0.25 * ((k & 3u) + 1));
      }
      node.link = BoundNode::makeLink(LeafKind::inner, Provenance::proven, first);
    }
    for (std::uint32_t k = 0; k < 16; ++k) tree->nodes[i + 4 * k] = node;
  }
  tree->outside = {8, 0, 8, BoundNode::makeLink(LeafKind::bounded, Provenance::proven, 0)};
  return tree;
}

struct TreeCase {
  double part;
  bool isFine;
};

class Trees : public ::testing::TestWithParam<TreeCase> {
 protected:
  Trees() : case_(pieces(0.25, 3.75)), setup_(case_), tree_(treeOf(case_, GetParam().part, GetParam().isFine)) {
    setup_.medium(0).tree = tree_.get();
  }

  TrackerCase case_;
  TrackerSetup setup_;
  std::unique_ptr<BoundTree> tree_;
};

/// `bias` is known, relative and far below the resolution: where there is hardly any noise it shows.
void expectMeans(const TrackerCase& c, TrackerSetup& setup, Tracker tracker, int samples, double bias = 0) {
  const Reference reference(c);
  Uniforms random(seedOfTest());
  std::array<RunningMean, 3> passed, scattered, emitted, thirds;
  for (int i = 0; i < samples; ++i) {
    const DistanceSample s = sampleDistance(tracker, setup, c, random);
    if (s.event == DistanceEvent::scattered) {
      ASSERT_GE(s.t, c.t0);
      ASSERT_LE(s.t, c.t1);
    }
    const bool isScattered = s.event == DistanceEvent::scattered;
    for (const int k : channels) {
      const auto at = static_cast<std::size_t>(k);
      passed[at].add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight[k]) : 0);
      scattered[at].add(isScattered ? static_cast<double>(s.weight[k]) : 0);
      emitted[at].add(static_cast<double>(s.emission[k]));
      const auto third = static_cast<std::size_t>(std::min(3 * (s.t - c.t0) / (c.t1 - c.t0), 2.0));
      thirds[at].add(isScattered && third == at ? static_cast<double>(s.weight.g) : 0);
    }
  }
  for (const int k : channels) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_TRUE(agrees(passed[at], reference.transmittance(c.t1, k))) << k;
    EXPECT_TRUE(agrees(scattered[at], reference.scattered(k))) << k;
    if (std::fabs(emitted[at].mean() / reference.emitted(k) - 1) > bias) {
      EXPECT_TRUE(agrees(emitted[at], reference.emitted(k))) << k;
    }
    const double expected = reference.scattered(1, k, 3);
    if (expected > 1e-3) EXPECT_TRUE(agrees(thirds[at], expected)) << "third " << k;
  }
}

TEST_P(Trees, NullScatteringHasTheRightMeans) {
  expectMeans(case_, setup_, Tracker::nullScattering, 2500000);
  EXPECT_EQ(setup_.evaluator().trackerStatistics().boundViolations, 0u) << "a leaf's own bound is never exceeded";
}

TEST_P(Trees, DecompositionHasTheRightMeans) {
  prepare(Tracker::decomposition, setup_, case_);
  expectMeans(case_, setup_, Tracker::decomposition, 2500000);
}

TEST_P(Trees, CandidatesHaveTheRightMeans) {
  prepare(Tracker::candidates, setup_, case_);
  expectMeans(case_, setup_, Tracker::candidates, 3000000);
}

/// Grey extinction: as many distances as light that is lost, each with the albedo as its weight. (A weight of null
/// collisions is at most 1 where the bound holds, so roulette does not touch it.)
TEST_P(Trees, DecompositionFallsAsTransmittance) {
  TrackerCase grey = case_;
  grey.media = {profile(densityAt, 5, Color(0.4f), Color(0.6f))};
  const std::unique_ptr<BoundTree> tree = treeOf(grey, 1, GetParam().isFine);
  TrackerSetup setup(grey);
  setup.medium(0).tree = tree.get();
  prepare(Tracker::decomposition, setup, grey);
  Uniforms random(seedOfTest());
  RunningMean passed;
  for (int i = 0; i < 1500000; ++i) {
    const DistanceSample s = sampleDistance(Tracker::decomposition, setup, grey, random);
    const bool isPassed = s.event == DistanceEvent::passed;
    ASSERT_NEAR(s.weight.g, isPassed ? 1.0f : 0.6f, 1e-4f);
    passed.add(isPassed);
  }
  EXPECT_TRUE(agrees(passed, Reference(grey).transmittance(grey.t1, 1)));
}

TEST_P(Trees, MarchingHasTheRightMeans) {
  case_.steps = 150;
  expectMeans(case_, setup_, Tracker::marching, 900000, 3e-4);
}

/// Mean and variance. With rate r = μ̄ - c over the control c the second moment of what is left of each leaf is
/// exp(∫ (1 - (σ-c)/r)² r - r - 2c dt), and no weight is larger than 1.
TEST_P(Trees, RatioTrackingHasTheRightMeanAndVariance) {
  const Reference reference(case_);
  Uniforms random(seedOfTest());
  RunningMean mean, square;
  double largest = 0;
  for (int i = 0; i < 1500000; ++i) {
    const Color value =
        setup_.evaluator().finish(volume::ratioTracking(setup_.evaluator(), setup_.ray(), setup_.span(0), random));
    mean.add(static_cast<double>(value.b));
    square.add(static_cast<double>(value.b) * static_cast<double>(value.b));
    largest = std::max(largest, static_cast<double>(maximum(abs(value))));
  }
  EXPECT_TRUE(agrees(mean, reference.transmittance(case_.t1, 2)));
  EXPECT_LE(largest, 1 + 1e-5);
  const double exponent = integrate(
      [&](double t) {
        const double sigma = reference.sigmaT(t, 2);
        const auto cell = static_cast<std::int32_t>(t / 4 * tree_->cellsPerSide());
        const BoundNode leaf = *tree_->find({cell, 0, 0}).leaf;
        if (leaf.kind() != LeafKind::bounded) return -2 * sigma;
        const auto control = static_cast<double>(leaf.control), rate = static_cast<double>(leaf.majorant) - control;
        return rate * std::pow(1 - (sigma - control) / rate, 2) - rate - 2 * control;
      },
      case_.t0, case_.t1, 4000);
  // Russian roulette below 0.05 adds to it.
  EXPECT_GE(square.mean(), 0.99 * std::exp(exponent));
  EXPECT_LE(square.mean(), 1.01 * std::exp(exponent) + 0.05 * mean.mean());
}

/// However low the working bound is: weights of collisions are multiplied along a path, and what exceeds 1 grows with
/// each of its vertices.
TEST_P(Trees, DistancesOfGreyMediaWeighAtMostTheAlbedo) {
  TrackerCase grey = case_;
  grey.media = {profile(densityAt, 5, Color(0.4f), Color(0.999f))};
  const std::unique_ptr<BoundTree> tree = treeOf(grey, GetParam().part, GetParam().isFine);
  TrackerSetup setup(grey);
  setup.medium(0).tree = tree.get();
  Uniforms random(seedOfTest());
  int scattered = 0;
  for (int i = 0; i < 100000; ++i) {
    const DistanceSample s = sampleDistance(Tracker::nullScattering, setup, grey, random);
    ASSERT_LE(s.weight.g, 1.0001f);
    ASSERT_GE(s.weight.g, 0.0f);
    scattered += s.event == DistanceEvent::scattered;
  }
  EXPECT_GT(scattered, 10000);
}

/// Nobody is asked where all is known: in the empty and in the uniform stretch.
TEST_P(Trees, KnownStretchesAreNotAsked) {
  Uniforms random(seedOfTest());
  std::vector<DensityEvaluator::Question> questions;
  setup_.evaluator().recordInto(&questions);
  for (int i = 0; i < 2000; ++i) {
    sampleDistance(Tracker::nullScattering, setup_, case_, random);
    setup_.evaluator().finish(volume::ratioTracking(setup_.evaluator(), setup_.ray(), setup_.span(0), random));
    sampleDistance(Tracker::marching, setup_, case_, random);
  }
  EXPECT_GT(questions.size(), 2000u);
  for (const auto& question : questions) ASSERT_GE(question.point.x, 2 - 1e-5f);
}

INSTANTIATE_TEST_SUITE_P(WorkingBounds, Trees,
                         ::testing::Values(TreeCase{1, false}, TreeCase{0.75, false}, TreeCase{0.5, false},
                                           TreeCase{1, true}, TreeCase{0.75, true}, TreeCase{0.5, true}),
                         [](const auto& info) {
                           return (info.param.isFine ? "fine" : "coarse") +
                                  std::to_string(static_cast<int>(100 * info.param.part));
                         });

/// The same from a million of the volume's sizes away, with the ray against the axis.
TEST(FarTrees, AMillionSizesAway) {
  for (const double distance : {1e5, 1e6, 1e7}) {
    const TrackerCase near = pieces(0.25, 3.75);
    TrackerCase c = near;
    const auto mirrored = [&](double t) { return 4 - (t - distance); };
    c.media = {profile([&](double t) { return densityAt(mirrored(t)); }, 5, Color(0.4f, 0.32f, 0.16f),
                       Color(0.9f, 0.8f, 0.95f), [&](double t) { return glowAt(mirrored(t)); })};
    c.t0 = distance + 0.25;
    c.t1 = distance + 3.75;
    const std::unique_ptr<BoundTree> tree = treeOf(near, 1, true);
    Medium medium;
    medium.tree = tree.get();
    DensityEvaluator evaluator(
        [&](const Medium&, Point<World> p) { return near.media[0].at(static_cast<double>(p.x)); });
    const Medium* const media[] = {&medium};
    Ray<World> ray;
    ray.origin = {static_cast<float>(distance + 4), -0.0f, 0.5f};
    ray.direction = {-1, -0.0f, 0};
    const Reference reference(c);
    Uniforms random(seedOfTest());
    RunningMean transmittance, passed;
    // The origin is a float: the volume is where that puts it.
    const double shift = static_cast<double>(ray.origin.x) - (distance + 4);
    const double t0 = c.t0 + shift, t1 = c.t1 + shift;
    for (int i = 0; i < 400000; ++i) {
      transmittance.add(static_cast<double>(
          evaluator.finish(volume::ratioTracking(evaluator, ray, volume::MediumSpan{t0, t1, &medium}, random)).b));
      const DistanceSample s = evaluator.finish(
          volume::sampleByNullScattering(evaluator, ray, volume::Segment{t0, t1, media}, Color(1), random));
      passed.add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight.b) : 0);
    }
    EXPECT_TRUE(agrees(transmittance, reference.transmittance(c.t1, 2))) << distance;
    EXPECT_TRUE(agrees(passed, reference.transmittance(c.t1, 2))) << distance;
    EXPECT_EQ(evaluator.trackerStatistics().boundViolations, 0u) << distance;
  }
}

}  // namespace
}  // namespace aerosol::test

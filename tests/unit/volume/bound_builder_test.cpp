#include "core/volume/bounds/bound_builder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aerosol::volume {
namespace {

constexpr float infinity = HUGE_VALF;

/// Extinction that falls from `core` at the middle to 0 at a radius of 0.5, flat within 0.2; known exactly.
class Ball : public BoundSource {
 public:
  float core = 10;
  bool proves = true;

  static double shape(double r) { return std::clamp((0.5 - r) / 0.3, 0.0, 1.0); }
  float densityAt(Point<Object> p) const {
    return core * static_cast<float>(
                      shape(std::hypot(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z))));
  }
  void prove(std::span<const Box<Object>> boxes, std::span<BoxKnowledge> knowledge) override {
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      double nearest = 0, farthest = 0;
      for (int i = 0; i < 3; ++i) {
        const double low = static_cast<double>(boxes[b].lower[i]), high = static_cast<double>(boxes[b].upper[i]);
        const double inner = low > 0 ? low : high < 0 ? -high : 0, outer = std::max(-low, high);
        nearest += inner * inner;
        farthest += outer * outer;
      }
      BoxKnowledge& k = knowledge[b];
      k.ranges.extinctionLow = core * static_cast<float>(shape(std::sqrt(farthest)));
      k.ranges.extinctionHigh = proves ? core * static_cast<float>(shape(std::sqrt(nearest))) : infinity;
      k.isEmpty = k.ranges.extinctionHigh == 0;
      k.isUniform = k.ranges.extinctionHigh == k.ranges.extinctionLow;
      k.uniformKey = 1;
    }
  }
  void sample(std::span<const Box<Object>> boxes, int count, std::span<BoxSamples> samples) override {
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      samples[b] = {infinity, 0, 0};
      for (int i = 0; i < count; ++i) {
        const float t = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
        const Vector<Object> d = boxes[b].upper - boxes[b].lower;
        const float value = densityAt(boxes[b].lower + Vector<Object>(d.x * t, d.y * t, d.z * t));
        samples[b].low = std::min(samples[b].low, value);
        samples[b].high = std::max(samples[b].high, value);
        samples[b].mean += value / static_cast<float>(count);
      }
    }
  }
  Coefficients at(Point<Object> p) override { return {.sigmaT = Color(densityAt(p))}; }
};

const Box<Object> cube{{-1, -1, -1}, {1, 1, 1}};

BoundNode leafAt(const BoundTree& tree, Point<Object> p) {
  std::array<std::int32_t, 3> cell{};
  for (int i = 0; i < 3; ++i) {
    cell[static_cast<std::size_t>(i)] =
        static_cast<std::int32_t>((p[i] + 1) / 2 * static_cast<float>(tree.cellsPerSide()));
  }
  return *tree.find(cell).leaf;
}

template <class Check>
void forPoints(Check check) {
  for (int i = 0; i < 40 * 40 * 40; ++i) {
    const auto at = [](int n) { return (static_cast<float>(n) + 0.37f) / 20 - 1; };
    check(Point<Object>(at(i % 40), at(i / 40 % 40), at(i / 1600)));
  }
}

TEST(BoundBuilder, LeavesHoldWhatTheyPromise) {
  Ball ball;
  ball.core = 100;
  BoundStatistics statistics;
  const BoundTree tree = buildBoundTree(ball, {.domain = cube, .objectToWorld = {}, .stepSize = 0.02f}, statistics);
  EXPECT_GT(tree.levels, 2);
  EXPECT_EQ(statistics.estimated + statistics.declared, 0u);
  EXPECT_GT(statistics.empty, 0u);
  EXPECT_GT(statistics.uniform, 0u);
  // A ball of radius 0.5 is 0.065 of the cube. It touches the faces of the cells around it, which are not worth
  // dividing.
  EXPECT_GT(statistics.emptyVolume, 0.5);
  EXPECT_LT(statistics.emptyVolume, 1 - 0.065);
  forPoints([&](Point<Object> p) {
    const BoundNode leaf = leafAt(tree, p);
    const float density = ball.densityAt(p);
    if (leaf.kind() == LeafKind::empty) ASSERT_EQ(density, 0);
    if (leaf.kind() == LeafKind::uniform) ASSERT_FLOAT_EQ(density, 100);
    if (leaf.kind() != LeafKind::bounded) return;
    ASSERT_LE(density, leaf.limit);
    ASSERT_GE(density, leaf.control);
    ASSERT_LE(leaf.majorant, leaf.limit);
    // |1 - (σ - c) / (μ̄ - c)| ≤ 1.
    ASSERT_LE(leaf.limit - leaf.control, 2 * (leaf.majorant - leaf.control) * 1.0001f);
  });
}

TEST(BoundBuilder, KeepsToItsBudget) {
  for (const std::uint64_t boxes : {0u, 100u, 1000u, 20000u}) {
    Ball ball;
    BoundStatistics statistics;
    const BoundTree tree =
        buildBoundTree(ball, {.domain = cube, .objectToWorld = {}, .budget = {.boxes = boxes}}, statistics);
    EXPECT_LE(statistics.boxes, std::max<std::uint64_t>(boxes, BoundTree::parts)) << "one division is the least";
  }
  for (const std::uint64_t bytes : {10000u, 100000u}) {
    Ball ball;
    BoundStatistics statistics;
    const BoundTree tree =
        buildBoundTree(ball, {.domain = cube, .objectToWorld = {}, .budget = {.bytes = bytes}}, statistics);
    EXPECT_LE(statistics.bytes, bytes);
  }
}

/// A dear shader is worth more steps over faces: its tree is finer, and wastes less.
TEST(BoundBuilder, DearPointsMakeFinerTrees) {
  Ball ball;
  ball.core = 60;
  std::size_t before = 0;
  double bound = infinity;
  for (const double cost : {0.1, 1.0, 4.0}) {
    BoundStatistics statistics;
    const BoundRequest request{.domain = cube, .objectToWorld = {}, .stepSize = 0.1f, .pointCost = cost};
    const BoundTree tree = buildBoundTree(ball, request, statistics);
    EXPECT_GT(tree.nodes.size(), before) << cost;
    EXPECT_LT(statistics.meanBound, bound) << cost;
    before = tree.nodes.size();
    bound = statistics.meanBound;
  }
}

TEST(BoundBuilder, DeclaredBoundsCap) {
  Ball ball;
  BoundStatistics statistics;
  const BoundTree tree = buildBoundTree(ball, {.domain = cube, .objectToWorld = {}, .declared = 4.0f}, statistics);
  EXPECT_GT(statistics.declared, 0u);
  forPoints([&](Point<Object> p) {
    const BoundNode leaf = leafAt(tree, p);
    if (leaf.kind() == LeafKind::bounded) ASSERT_LE(leaf.majorant, 4);
  });
}

/// Where nothing is proven nothing is empty, and there is a positive floor.
TEST(BoundBuilder, EstimatesHaveAFloor) {
  Ball ball;
  ball.proves = false;
  BoundStatistics statistics;
  const BoundTree tree = buildBoundTree(
      ball, {.domain = cube, .objectToWorld = {}, .stepSize = 0.5f, .budget = {.boxes = 2000}}, statistics);
  EXPECT_EQ(statistics.empty + statistics.uniform + statistics.proven, 0u);
  EXPECT_GT(statistics.estimated, 0u);
  forPoints([&](Point<Object> p) { ASSERT_GE(leafAt(tree, p).majorant, 2); });
}

TEST(BoundBuilder, NobodyIsLeftOutWhenMessagesWouldBe) {
  Ball ball;
  BoundStatistics statistics;
  const BoundTree tree = buildBoundTree(
      ball, {.domain = cube, .objectToWorld = {}, .mayLeaveOut = false, .budget = {.boxes = 2000}}, statistics);
  EXPECT_EQ(statistics.empty + statistics.uniform, 0u);
}

}  // namespace
}  // namespace aerosol::volume

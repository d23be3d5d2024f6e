#include "core/render/volume_light.h"

#include <gtest/gtest.h>

#include "tests/statistical/direction_grid.h"
#include "tests/statistical/statistics.h"

// Media as lights: directions follow their density, which integrates to one, from outside and from within.

namespace aerosol::render {
namespace {

using test::countsAgree;
using test::DirectionGrid;
using test::seedOfTest;
using test::Uniforms;
using volume::BoundNode;
using volume::BoundTree;
using volume::LeafKind;

/// Rotated, stretched, moved.
Transform<World, Object> placement() {
  const Matrix4 m{{{0, -1.5, 0.2, 0.5}, {1, 0, 0, -0.3}, {0.1, 0, 0.8, 0.2}, {0, 0, 0, 1}}};
  Matrix4 inverse;
  EXPECT_TRUE(invert(m, inverse));
  return {m, inverse};
}

/// Two levels, with emission in some of the leaves.
BoundTree unevenTree() {
  BoundTree tree;
  tree.domain = {{-1, -1, -1}, {1, 1, 1}};
  tree.objectToWorld = placement();
  tree.levels = 2;
  BoundNode bounded;
  bounded.link = BoundNode::makeLink(LeafKind::bounded, volume::Provenance::proven, 0);
  tree.nodes.assign(2 * BoundTree::parts, bounded);
  tree.ranges.resize(tree.nodes.size());
  tree.nodes[21].link = BoundNode::makeLink(LeafKind::inner, volume::Provenance::proven, BoundTree::parts);
  for (std::uint32_t i = 0; i < BoundTree::parts; ++i) {
    tree.ranges[i].emissionHigh = i % 5 == 0 ? 1 + static_cast<float>(i % 7) : 0;
    tree.ranges[BoundTree::parts + i].emissionHigh = i % 3 == 0 ? 40 : 0;
  }
  tree.outside.link = BoundNode::makeLink(LeafKind::empty, volume::Provenance::proven, 0);
  return tree;
}

::testing::AssertionResult followsItsDensity(const VolumeLight& light, Point<World> from, std::uint64_t seed,
                                             float fault = 1) {
  constexpr int samples = 200000;
  const DirectionGrid grid({0, 0, 1}, 2, 12, 12);
  std::vector<double> expected =
      grid.integrateCells([&](Vector<World> d) { return static_cast<double>(light.pdfEscaped(from, d)); }, 40);
  double total = 0;
  for (double& e : expected) {
    total += e;
    e *= samples;
  }
  if (std::fabs(total - 1) > 5e-3) return ::testing::AssertionFailure() << "the density integrates to " << total;
  std::vector<double> observed(grid.cellCount());
  Uniforms random(seed);
  for (int i = 0; i < samples; ++i) {
    auto u = random.next2D();
    u[1] *= fault;
    const auto s = light.sample(from, {random.next(), u});
    if (!s) return ::testing::AssertionFailure() << "no sample";
    if (std::fabs(light.pdfEscaped(from, s->direction) / s->pdf - 1) > 1e-3f) {
      return ::testing::AssertionFailure() << "densities differ";
    }
    ++observed[grid.cell(s->direction)];
  }
  // Cells are integrated to a few parts in a thousand: compare them no finer than that.
  double statistic = 0, degrees = 0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] < 20) continue;
    const double variance = expected[i] + std::pow(1e-2 * expected[i], 2);
    statistic += std::pow(observed[i] - expected[i], 2) / variance;
    ++degrees;
  }
  const double p = test::chiSquaredTail(statistic, degrees);
  if (!(p > test::minimumP)) return ::testing::AssertionFailure() << "chi-squared " << statistic << " of " << degrees;
  return ::testing::AssertionSuccess();
}

TEST(VolumeLights, OfATreeFollowTheirDensity) {
  const BoundTree tree = unevenTree();
  const auto light = VolumeLight::make(tree);
  ASSERT_TRUE(light);
  for (const Point<World> from : {Point<World>(3, 1, -2), {0.5f, -0.3f, 0.2f}, {0.1f, 2.5f, 0.4f}}) {
    EXPECT_TRUE(followsItsDensity(*light, from, seedOfTest(static_cast<std::uint64_t>(from.x * 10)))) << from.x;
  }
  EXPECT_FALSE(followsItsDensity(*light, {3, 1, -2}, seedOfTest(), 0.9f));
}

TEST(VolumeLights, OfAConstantFollowTheirDensity) {
  const auto light = VolumeLight::make({{-1, -0.5f, -2}, {1, 0.5f, 0}}, placement(), Color(0.5f, 1, 0.25f));
  ASSERT_TRUE(light);
  for (const Point<World> from : {Point<World>(3, 1, -2), {0.5f, -0.3f, -0.6f}}) {
    EXPECT_TRUE(followsItsDensity(*light, from, seedOfTest(static_cast<std::uint64_t>(from.x * 10)))) << from.x;
  }
}

TEST(VolumeLights, WhatDoesNotGlowIsNone) {
  EXPECT_FALSE(VolumeLight::make({{-1, -1, -1}, {1, 1, 1}}, {}, Color()));
  BoundTree dark = unevenTree();
  for (volume::BoundRanges& r : dark.ranges) r.emissionHigh = 0;
  EXPECT_FALSE(VolumeLight::make(dark));
  BoundTree unknown = unevenTree();
  unknown.ranges[5].emissionHigh = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(VolumeLight::make(unknown));
}

}  // namespace
}  // namespace aerosol::render

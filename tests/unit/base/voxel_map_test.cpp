// Maps of voxels in frustums, against the formulas written out for each voxel.

#include "core/base/voxel_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aerosol {
namespace {

using Triple = VoxelMap::Triple;

/// A turned, sheared and shifted space.
const Matrix4 placed = {{{0.8, -0.6, 0.1, 3}, {0.6, 0.8, -0.2, -1}, {0.05, 0.1, 1.5, 2}, {0, 0, 0, 1}}};

Triple placedPoint(const Matrix4& m, const Triple& p) {
  Triple q;
  for (std::size_t r = 0; r < 3; ++r) q[r] = m[r][0] * p[0] + m[r][1] * p[1] + m[r][2] * p[2] + m[r][3];
  return q;
}

Matrix4 inverseOf(const Matrix4& m) {
  Matrix4 inverse;
  EXPECT_TRUE(invert(m, inverse));
  return inverse;
}

constexpr Triple least{-0.5, 1.5, -2}, greatest{23.5, 19.5, 28};
constexpr double taper = 0.25, depth = 6;

/// OpenVDB's map, from voxel to space.
Triple linearDepthByHand(const Triple& index) {
  const double width = greatest[0] - least[0];
  const double z = (index[2] - least[2]) * depth / (greatest[2] - least[2]);
  const double scale = ((1 / taper - 1) / depth * z + 1) / width;
  const Triple q{(index[0] - least[0] - 0.5 * width) * scale,
                 (index[1] - least[1] - 0.5 * (greatest[1] - least[1])) * scale, z};
  return placedPoint(placed, q);
}

VoxelMap linearDepth() { return VoxelMap::linearDepth(least, greatest, taper, depth, inverseOf(placed)); }

/// A view from 1 to 9 along z, 24 by 18 by 30 voxels.
const Matrix4 view = {{{20, 0, 11.5, 0}, {0, 18, 8.5, 0}, {0, 0, 33.25, -33.75}, {0, 0, 1, 0}}};

Triple projectiveByHand(const Triple& index) {
  const double z = 33.75 / (33.25 - index[2]);
  return placedPoint(placed, {(index[0] - 11.5) * z / 20, (index[1] - 8.5) * z / 18, z});
}

VoxelMap projective() { return VoxelMap::projective(multiply(view, inverseOf(placed))); }

struct Case {
  VoxelMap map;
  Triple (*byHand)(const Triple&);
};
std::vector<Case> cases() { return {{linearDepth(), linearDepthByHand}, {projective(), projectiveByHand}}; }

void expectNear(const std::optional<Triple>& found, const Triple& expected, double error) {
  ASSERT_TRUE(found);
  for (std::size_t r = 0; r < 3; ++r) EXPECT_NEAR((*found)[r], expected[r], error);
}

TEST(VoxelMaps, EveryVoxel) {
  for (const auto& [map, byHand] : cases()) {
    for (int x = 0; x < 24; ++x) {
      for (int y = 0; y < 18; ++y) {
        for (int z = 0; z < 30; ++z) {
          const Triple index{double(x), double(y), double(z)}, place = byHand(index);
          expectNear(map.toIndex(place), index, 1e-10);
          expectNear(map.toFile(index), place, 1e-10);
        }
      }
    }
  }
}

TEST(VoxelMaps, PlanesOfTheGridArePlanesOfSpace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const auto& [map, byHand] : cases()) {
    for (int i = 0; i < 2000; ++i) {
      const Triple index{24 * uniform(random), 18 * uniform(random), 30 * uniform(random)}, place = byHand(index);
      for (std::size_t r = 0; r < 3; ++r) {
        const auto value = [&](double position) {
          const VoxelMap::Form plane = map.plane(r, position);
          return plane[0] * place[0] + plane[1] * place[1] + plane[2] * place[2] + plane[3];
        };
        EXPECT_NEAR(value(index[r]), 0, 1e-10);
        EXPECT_GT(value(index[r] - 0.1), 0);
        EXPECT_LT(value(index[r] + 0.1), 0);
      }
    }
  }
}

TEST(VoxelMaps, OfPlacedSpaces) {
  for (const auto& [map, byHand] : cases()) {
    const VoxelMap moved = map.after(inverseOf(placed));
    const Triple index{3, 7, 11};
    expectNear(moved.toIndex(placedPoint(placed, byHand(index))), index, 1e-9);
    expectNear(moved.toFile(index), placedPoint(placed, byHand(index)), 1e-9);
    ASSERT_TRUE(map.eye && moved.eye);
    expectNear(moved.eye, placedPoint(placed, *map.eye), 1e-9);
  }
}

/// The eye, and what is behind it.
TEST(VoxelMaps, NothingIsBehindTheEye) {
  const VoxelMap map = projective();
  expectNear(map.eye, placedPoint(placed, {0, 0, 0}), 1e-12);
  EXPECT_FALSE(map.toIndex(placedPoint(placed, {0.1, 0.2, -0.5})));
  EXPECT_FALSE(map.toIndex(placedPoint(placed, {0, 0, 0})));
  // Where w is 0: 2 in front of the near end, as the view has grown fourfold on 6.
  const VoxelMap linear = linearDepth();
  expectNear(linear.eye, placedPoint(placed, {0, 0, -2}), 1e-12);
  EXPECT_FALSE(linear.toIndex(placedPoint(placed, {0, 0, -2.001})));
  EXPECT_TRUE(linear.toIndex(placedPoint(placed, {0, 0, -1.999})));
  EXPECT_FALSE(linear.toFile({3, 3, -20}));
}

TEST(VoxelMaps, BoxesHoldAllTheirPoints) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const auto& [map, byHand] : cases()) {
    for (int i = 0; i < 500; ++i) {
      const Triple centre = byHand({24 * uniform(random), 18 * uniform(random), 30 * uniform(random)});
      const double size = std::pow(10, -4 * uniform(random));
      Triple lower = centre, upper = centre, low, high;
      for (std::size_t r = 0; r < 3; ++r) {
        lower[r] -= size * uniform(random);
        upper[r] += size * uniform(random);
      }
      if (!map.indexBox(lower, upper, low, high)) continue;
      for (int k = 0; k < 50; ++k) {
        Triple p;
        for (std::size_t r = 0; r < 3; ++r) {
          const double u = uniform(random);
          p[r] = u < 0.3 ? lower[r] : u > 0.7 ? upper[r] : lower[r] + uniform(random) * (upper[r] - lower[r]);
        }
        const auto index = map.toIndex(p);
        ASSERT_TRUE(index);
        for (std::size_t r = 0; r < 3; ++r) {
          ASSERT_GE((*index)[r], low[r]);
          ASSERT_LE((*index)[r], high[r]);
        }
      }
    }
    Triple low, high;
    EXPECT_FALSE(map.indexBox({-100, -100, -100}, {100, 100, 100}, low, high));
    map.fileBox({0, 0, 0}, {23, 17, 29}, low, high);
    for (int k = 0; k < 500; ++k) {
      const Triple p = byHand({23 * uniform(random), 17 * uniform(random), 29 * uniform(random)});
      for (std::size_t r = 0; r < 3; ++r) {
        EXPECT_GE(p[r], low[r] - 1e-9);
        EXPECT_LE(p[r], high[r] + 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace aerosol

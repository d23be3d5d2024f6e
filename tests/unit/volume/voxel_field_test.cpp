#include "core/volume/trackers/voxel_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace aerosol::volume {
namespace {

/// Random values on 13 x 7 x 10 voxels that begin at (-5, 3, -1), a part of them 0.
struct Block {
  std::array<std::int32_t, 3> first{-5, 3, -1}, size{13, 7, 10};
  std::vector<float> values;

  explicit Block(std::uint32_t seed, double emptyPart = 0.3) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int i = 0; i < size[0] * size[1] * size[2]; ++i) {
      values.push_back(static_cast<double>(uniform(random)) < emptyPart ? 0.0f : 2 * uniform(random));
    }
  }
  long double voxel(std::int32_t i, std::int32_t j, std::int32_t k) const {
    const std::array<std::int32_t, 3> p{i - first[0], j - first[1], k - first[2]};
    for (std::size_t a = 0; a < 3; ++a) {
      if (p[a] < 0 || p[a] >= size[a]) return 0;
    }
    return static_cast<long double>(values[static_cast<std::size_t>(p[0] + size[0] * (p[1] + size[1] * p[2]))]);
  }
  /// The field at a place, from its definition.
  long double at(std::array<long double, 3> p, VoxelKernel kernel) const {
    if (kernel == VoxelKernel::constant) {
      const auto nearest = [&](std::size_t a) { return static_cast<std::int32_t>(std::floor(p[a] + 0.5L)); };
      return voxel(nearest(0), nearest(1), nearest(2));
    }
    std::array<std::int32_t, 3> cell;
    std::array<long double, 3> part;
    for (std::size_t a = 0; a < 3; ++a) {
      cell[a] = static_cast<std::int32_t>(std::floor(p[a]));
      part[a] = p[a] - static_cast<long double>(cell[a]);
    }
    long double sum = 0;
    for (std::size_t n = 0; n < 8; ++n) {
      long double weight = 1;
      for (std::size_t a = 0; a < 3; ++a) weight *= (n >> a & 1u) != 0 ? part[a] : 1 - part[a];
      sum +=
          weight * voxel(cell[0] + static_cast<std::int32_t>(n & 1u), cell[1] + static_cast<std::int32_t>(n >> 1 & 1u),
                         cell[2] + static_cast<std::int32_t>(n >> 2));
    }
    return sum;
  }
  VoxelField field(VoxelKernel kernel) const { return VoxelField::ofValues(first, size, values, kernel); }
};

long double valueOnRay(const Block& block, VoxelKernel kernel, const FieldRay& ray, long double t) {
  std::array<long double, 3> p;
  for (std::size_t a = 0; a < 3; ++a) {
    p[a] = static_cast<long double>(ray.origin[a]) + t * static_cast<long double>(ray.direction[a]);
  }
  return block.at(p, kernel);
}

/// ∫ by three-point Gauss–Legendre, which is exact for the cubics between two faces; the faces are found by brute
/// force.
long double reference(const Block& block, VoxelKernel kernel, const FieldRay& ray, long double t0, long double t1) {
  std::vector<long double> cuts{t0, t1};
  const long double shift = kernel == VoxelKernel::constant ? 0.5L : 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) continue;
    for (int face = -40; face <= 40; ++face) {
      const long double t =
          (face + shift - static_cast<long double>(ray.origin[a])) / static_cast<long double>(ray.direction[a]);
      if (t > t0 && t < t1) cuts.push_back(t);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  long double sum = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const long double half = (cuts[i + 1] - cuts[i]) / 2, centre = cuts[i] + half, node = std::sqrt(0.6L) * half;
    sum += half / 9 *
           (8 * valueOnRay(block, kernel, ray, centre) + 5 * valueOnRay(block, kernel, ray, centre - node) +
            5 * valueOnRay(block, kernel, ray, centre + node));
  }
  return sum;
}

class VoxelFields : public ::testing::TestWithParam<VoxelKernel> {
 protected:
  FieldRay randomRay() {
    std::uniform_real_distribution<double> uniform(-1, 1);
    FieldRay ray;
    ray.origin = {15 * uniform(random_), 5 + 15 * uniform(random_), 4 + 15 * uniform(random_)};
    const std::array<double, 3> target{1 + 6 * uniform(random_), 6 + 4 * uniform(random_), 4 + 5 * uniform(random_)};
    for (std::size_t a = 0; a < 3; ++a) ray.direction[a] = (target[a] - ray.origin[a]) / 10;
    return ray;
  }
  std::mt19937 random_{7};
};

TEST_P(VoxelFields, IntegralsMeetQuadrature) {
  const Block block(1);
  const VoxelField field = block.field(GetParam());
  int count = 0;
  for (int i = 0; i < 2000; ++i) {
    const FieldRay ray = randomRay();
    std::uniform_real_distribution<double> uniform(0, 30);
    double t0 = uniform(random_), t1 = uniform(random_);
    if (t0 > t1) std::swap(t0, t1);
    const auto expected = static_cast<double>(reference(block, GetParam(), ray, t0, t1));
    ASSERT_NEAR(integrate(field, ray, t0, t1), expected, 1e-10 * (1 + expected)) << "ray " << i;
    count += expected > 0;
  }
  EXPECT_GT(count, 500);
}

TEST_P(VoxelFields, ValuesAreThoseOfTheKernel) {
  const Block block(2);
  const VoxelField field = block.field(GetParam());
  for (int i = 0; i < 2000; ++i) {
    const FieldRay ray = randomRay();
    const double t = std::uniform_real_distribution<double>(5, 15)(random_);
    ASSERT_NEAR(valueAt(field, ray, t), static_cast<double>(valueOnRay(block, GetParam(), ray, t)), 1e-9);
  }
}

TEST_P(VoxelFields, DepthsAreFoundWhereTheyAreReached) {
  const Block block(3);
  const VoxelField field = block.field(GetParam());
  for (int i = 0; i < 2000; ++i) {
    const FieldRay ray = randomRay();
    const double whole = integrate(field, ray, 0, 30);
    const double depth = whole * std::uniform_real_distribution<double>(0, 1)(random_);
    const FieldPlace place = findDepth(field, ray, 0, 30, depth);
    if (!(whole > 0)) {
      EXPECT_FALSE(place.isReached);
      continue;
    }
    ASSERT_TRUE(place.isReached);
    ASSERT_NEAR(integrate(field, ray, 0, place.t), depth, 1e-10 * whole);
    const FieldPlace beyond = findDepth(field, ray, 0, 30, 1.001 * whole);
    EXPECT_FALSE(beyond.isReached);
    EXPECT_DOUBLE_EQ(beyond.depth, whole);
  }
}

TEST_P(VoxelFields, RaysAlongAxesAndFaces) {
  const Block block(4, 0);
  const VoxelField field = block.field(GetParam());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      FieldRay ray{{1.25, 6.5, 4.125}, {0, 0, 0}};
      ray.origin[axis] = -sign * 40;
      ray.direction[axis] = sign;
      EXPECT_NEAR(integrate(field, ray, 0, 80), static_cast<double>(reference(block, GetParam(), ray, 0, 80)), 1e-11);
      // In the plane between cells: either of the two is right, and they agree for the trilinear kernel.
      ray.origin[(axis + 1) % 3] = GetParam() == VoxelKernel::constant ? 5.5 : 5;
      const double onFace = integrate(field, ray, 0, 80);
      EXPECT_GT(onFace, 0);
      if (GetParam() == VoxelKernel::trilinear) {
        EXPECT_NEAR(onFace, static_cast<double>(reference(block, GetParam(), ray, 0, 80)), 1e-11);
      }
      EXPECT_EQ(integrate(field, ray, 0, std::numeric_limits<double>::infinity()), onFace);
    }
  }
}

TEST_P(VoxelFields, RaysBesideTheFieldMeetNothing) {
  const VoxelField field = Block(5).field(GetParam());
  EXPECT_EQ(integrate(field, {{-100, 100, 4}, {1, 0, 0}}, 0, 1000), 0);
  EXPECT_EQ(integrate(field, {{-100, 6, 4}, {-1, 0, 0}}, 0, 1000), 0);
  EXPECT_EQ(integrate(field, {{0, 6, 4}, {1, 0, 0}}, 3, 3), 0);
  EXPECT_EQ(valueAt(field, {{0, 600, 4}, {1, 0, 0}}, 3), 0);
}

INSTANTIATE_TEST_SUITE_P(Kernels, VoxelFields, ::testing::Values(VoxelKernel::constant, VoxelKernel::trilinear),
                         [](const auto& info) {
                           return info.param == VoxelKernel::constant ? "constant" : "trilinear";
                         });

TEST(VoxelFieldTest, BricksOfOneValueCountAsOneCell) {
  const std::vector<float> values(40 * 40 * 40, 1.5f);
  const VoxelField field = VoxelField::ofValues({-20, -20, -20}, {40, 40, 40}, values, VoxelKernel::trilinear);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> inside(-19, 18);
  int cells = 0;
  for (int i = 0; i < 1000; ++i) {
    FieldRay ray;
    for (std::size_t a = 0; a < 3; ++a) {
      ray.origin[a] = inside(random);
      ray.direction[a] = inside(random) - ray.origin[a];
    }
    const double length = std::uniform_real_distribution<double>(0, 1)(random);
    ASSERT_NEAR(integrate(field, ray, 0, length), 1.5 * length, 1e-12);
    const FieldPlace place = findDepth(field, ray, 0, 1, 1.5 * length);
    ASSERT_TRUE(place.isReached);
    ASSERT_NEAR(place.t, length, 1e-12);
    for (VoxelWalk walk(field, ray, 0, 1); walk.next();) ++cells;
  }
  EXPECT_LT(cells, 25 * 1000);  // A ray is 20 voxels long in the mean, but meets more than one cell a voxel.
}

TEST(CellCubicTest, InverseOfFlatAndSteepEnds) {
  // Flat at both ends, and a triple zero at one: Newton alone would leave the bracket.
  for (const CellCubic cubic : {CellCubic{{0, 0, 0, 4}}, CellCubic{{0, 6, -6, 0}}, CellCubic{{1e-9, 0, 0, 1e9}},
                                CellCubic{{1e9, -1e9, 0, 0}}, CellCubic{{3, 0, 0, 0}}}) {
    const double whole = cubic.integral(1);
    double before = -1;
    for (int i = 0; i <= 1000; ++i) {
      const double depth = whole * i / 1000, s = cubic.inverse(depth, 1);
      ASSERT_NEAR(cubic.integral(s), depth, 1e-13 * whole);
      ASSERT_GE(s, before);
      before = s;
    }
    EXPECT_LE(before, 1);
  }
}

/// A grid of one voxel value in every cell of a box.
class OneBox final : public VoxelGrid {
 public:
  VoxelGridInfo about;

  OneBox() {
    about.channels = 1;
    about.isEmpty = false;
    about.indexBounds = {0, 0, 0, 3, 3, 3};
    about.bounds = {-0.05, -0.05, -0.05, 0.35, 0.35, 0.35};
    about.voxelSize = {0.1, 0.1, 0.1};
    about.indexToFile = {0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 1};
    about.greatest = {3, 0, 0};
  }
  const VoxelGridInfo& info() const override { return about; }
  void sample(VoxelInterpolation, std::size_t count, const float* x, const float* y, const float* z,
              float* results) const override {
    for (std::size_t i = 0; i < count; ++i) {
      const auto inside = [](float v) { return v > -0.05f && v < 0.35f; };
      results[i] = inside(x[i]) && inside(y[i]) && inside(z[i]) ? 3.0f : 0.0f;
    }
  }
  VoxelRange range(VoxelInterpolation, const std::array<double, 3>&, const std::array<double, 3>&, int) const override {
    return {0, 3, false};
  }
  std::vector<VoxelBox> activeBoxes() const override { return {{{0, 0, 0}, {3, 3, 3}}}; }
};

TEST(VoxelFieldOfAGrid, HoldsItsVoxels) {
  const OneBox grid;
  const auto field = VoxelField::make(grid, VoxelKernel::constant, 1 << 20);
  ASSERT_TRUE(field);
  EXPECT_NEAR(integrate(*field, {{-10, 1, 2}, {1, 0, 0}}, 0, 100), 12, 1e-12);
  const auto smooth = VoxelField::make(grid, VoxelKernel::trilinear, 1 << 20);
  ASSERT_TRUE(smooth);
  // Ramps of one cell on both sides add one cell in all.
  EXPECT_NEAR(integrate(*smooth, {{-10, 1, 2}, {1, 0, 0}}, 0, 100), 12, 1e-12);
}

TEST(VoxelFieldOfAGrid, RefusesWhatItCannotHold) {
  const auto isRefused = [](auto change, std::uint64_t bytes = 1 << 20) {
    OneBox grid;
    change(grid.about);
    return !VoxelField::make(grid, VoxelKernel::trilinear, bytes);
  };
  EXPECT_FALSE(isRefused([](VoxelGridInfo&) {}));
  EXPECT_TRUE(isRefused([](VoxelGridInfo&) {}, 1000));
  EXPECT_TRUE(isRefused([](VoxelGridInfo& i) { i.background[0] = 1; }));
  EXPECT_TRUE(isRefused([](VoxelGridInfo& i) { i.least[0] = -1; }));
  EXPECT_TRUE(isRefused([](VoxelGridInfo& i) { i.nanValues = 1; }));
  EXPECT_TRUE(isRefused([](VoxelGridInfo& i) { i.channels = 3; }));
  EXPECT_TRUE(isRefused([](VoxelGridInfo& i) { i.purpose = "level set"; }));
  EXPECT_TRUE(isRefused([](VoxelGridInfo& i) { i.bounds[3] = 1e6; }));
  EXPECT_TRUE(isRefused([](VoxelGridInfo& i) { i.bounds[4] = 0.3; }));  // A map that is no matrix.
}

}  // namespace
}  // namespace aerosol::volume

// Voxels in frustums through files: written, read, and looked up where each stands.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "core/grid/grid_file.h"
#include "core/grid/grid_writer.h"

namespace aerosol::grid {
namespace {

constexpr int size = 24;

float valueAt(int x, int y, int z) { return static_cast<float>(1 + x + 25 * y + 625 * z); }

NewFrustum linearDepth() {
  NewFrustum frustum;
  frustum.least = {-0.5, -0.5, -0.5};
  frustum.greatest = {size - 0.5, size - 0.5, size - 0.5};
  frustum.taper = 0.25;
  frustum.depth = 6;
  frustum.secondToFile = {0.8, -0.6, 0, 3, 0.6, 0.8, 0, -1, 0, 0, 1.5, 2, 0, 0, 0, 1};
  return frustum;
}

/// By OpenVDB's description of its map.
std::array<double, 3> linearDepthByHand(double x, double y, double z) {
  const double depth = (z + 0.5) * 6 / size, scale = (0.5 * depth + 1) / size;
  const double qx = (x + 0.5 - size / 2.0) * scale, qy = (y + 0.5 - size / 2.0) * scale;
  return {0.8 * qx - 0.6 * qy + 3, 0.6 * qx + 0.8 * qy - 1, 1.5 * depth + 2};
}

NewFrustum projective() {
  NewFrustum frustum;
  frustum.fileToIndex = {20, 0, 11.5, 0, 0, 18, 11.5, 0, 0, 0, 26, -26.5, 0, 0, 1, 0};
  return frustum;
}

std::array<double, 3> projectiveByHand(double x, double y, double z) {
  const double w = 26.5 / (26 - z);
  return {(x - 11.5) * w / 20, (y - 11.5) * w / 18, w};
}

class FrustumFiles : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  const VoxelGrid* write(const NewFrustum& frustum) {
    NewGrid grid;
    grid.name = "density";
    grid.frustum = frustum;
    for (int x = 0; x < size; x += 8) {
      for (int y = 0; y < size; y += 8) {
        for (int z = 0; z < size; z += 8) {
          VoxelBlock block{{x, y, z}, {}};
          for (int n = 0; n < 512; ++n) block.values.push_back(valueAt(x + n / 64, y + n / 8 % 8, z + n % 8));
          grid.blocks.push_back(std::move(block));
        }
      }
    }
    const Diagnostics errors = writeGrids(path_, {&grid, 1}, false);
    EXPECT_FALSE(errors.hasErrors()) << format(errors);
    auto file = readGrids(path_);
    EXPECT_TRUE(file) << format(file.errors());
    if (!file) return nullptr;
    file_ = *file;
    return file_->find("density");
  }

  const std::string path_ =
      (std::filesystem::temp_directory_path() / ("aerosol_frustum_" + std::to_string(getpid()) + ".vdb")).string();
  std::shared_ptr<const VoxelFile> file_;
};

template <class ByHand>
void expectEveryVoxel(const VoxelGrid& grid, ByHand byHand) {
  std::vector<float> x, y, z;
  for (int i = 0; i < size * size * size; ++i) {
    const auto p = byHand(i % size, i / size % size, i / size / size);
    x.push_back(static_cast<float>(p[0]));
    y.push_back(static_cast<float>(p[1]));
    z.push_back(static_cast<float>(p[2]));
  }
  std::vector<float> found(x.size());
  grid.sample(VoxelInterpolation::nearest, x.size(), x.data(), y.data(), z.data(), found.data());
  for (int i = 0; i < size * size * size; ++i) {
    ASSERT_EQ(found[static_cast<std::size_t>(i)], valueAt(i % size, i / size % size, i / size / size)) << i;
  }
  // Values are linear in the index: so is what lies between.
  const auto between = byHand(5.25, 7.5, 9.75);
  const float bx = static_cast<float>(between[0]), by = static_cast<float>(between[1]),
              bz = static_cast<float>(between[2]);
  float value = 0;
  grid.sample(VoxelInterpolation::trilinear, 1, &bx, &by, &bz, &value);
  EXPECT_NEAR(value, 1 + 5.25 + 25 * 7.5 + 625 * 9.75, 0.05);
  // Ranges hold what lookups give.
  for (int i = 0; i + 4000 < size * size * size; i += 97) {
    const auto k = static_cast<std::size_t>(i), m = k + 3;
    const VoxelRange range =
        grid.range(VoxelInterpolation::nearest, {std::min(x[k], x[m]), std::min(y[k], y[m]), std::min(z[k], z[m])},
                   {std::max(x[k], x[m]), std::max(y[k], y[m]), std::max(z[k], z[m])}, 0);
    EXPECT_LE(range.least, std::min(found[k], found[m]));
    EXPECT_GE(range.greatest, std::max(found[k], found[m]));
  }
}

TEST_F(FrustumFiles, LinearDepth) {
  const VoxelGrid* grid = write(linearDepth());
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->info().problem, "");
  ASSERT_TRUE(grid->info().frustum);
  expectEveryVoxel(*grid, linearDepthByHand);
  // The bounds are what OpenVDB makes of its own map.
  std::array<double, 3> lower{1e30, 1e30, 1e30}, upper{-1e30, -1e30, -1e30};
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto p = linearDepthByHand(corner & 1u ? 23.5 : -0.5, corner & 2u ? 23.5 : -0.5, corner & 4u ? 23.5 : -0.5);
    for (std::size_t r = 0; r < 3; ++r) {
      lower[r] = std::min(lower[r], p[r]);
      upper[r] = std::max(upper[r], p[r]);
    }
  }
  for (std::size_t r = 0; r < 3; ++r) {
    EXPECT_NEAR(grid->info().bounds[r], lower[r], 1e-6);
    EXPECT_NEAR(grid->info().bounds[3 + r], upper[r], 1e-6);
  }
}

TEST_F(FrustumFiles, Projective) {
  const VoxelGrid* grid = write(projective());
  ASSERT_TRUE(grid);
  ASSERT_TRUE(grid->info().frustum);
  expectEveryVoxel(*grid, projectiveByHand);
  // Behind the eye is background, and so it is in ranges.
  const float zero = 0, behind = -1;
  float value = 1;
  grid->sample(VoxelInterpolation::trilinear, 1, &zero, &zero, &behind, &value);
  EXPECT_EQ(value, 0);
  EXPECT_EQ(grid->range(VoxelInterpolation::trilinear, {-1, -1, -1}, {1, 1, 1}, 0).least, 0);
}

TEST_F(FrustumFiles, FlatOnesAreRefused) {
  NewFrustum frustum = projective();
  (*frustum.fileToIndex)[0] = std::nan("");
  const VoxelGrid* grid = write(frustum);
  EXPECT_FALSE(grid && grid->info().problem.empty());
}

}  // namespace
}  // namespace aerosol::grid

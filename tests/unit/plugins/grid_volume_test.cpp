// Volumes of voxel grids: where they are, and what is wrong with their files.

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/accel/volume_shape.h"
#include "core/render/registry.h"
#include "core/render/scene_services.h"
#include "plugins/registration.h"

namespace aerosol::render {
namespace {

class GridVolumes : public testing::Test {
 protected:
  void SetUp() override { registerPlugins(registry_); }

  Result<std::unique_ptr<const accel::VolumeShape>> make(const std::string& file, const std::string& grid) {
    volume_.type = "grid";
    volume_.parameters = {{"filename", file},  {"grid", grid},  {"interpolation", std::string("tricubic")},
                          {"frame", frame_},   {"blend", true}, {"frame_offset", -1.0f},
                          {"overlay_cells", 0}};
    volume_.origin.location = {"scene.xml", 7, 5};
    const std::vector<std::filesystem::path> folders = {AEROSOL_SOURCE_DIR "/tests/language/textures", folder_};
    services_ = makeServices({folders, 16});
    const Transform<World, Object> toWorld({{{2, 0, 0, 10}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}}},
                                           {{{0.5, 0, 0, -5}, {0, 0.5, 0, 0}, {0, 0, 0.5, 0}, {0, 0, 0, 1}}});
    return registry_.volume("grid")->make({volume_, toWorld, folders, warnings_, services_.get()});
  }

  /// A file of Mitsuba's form with 2 x 1 x 1 voxels over [0, 4] x [0, 1] x [0, 1].
  void writeDense(const std::string& name, float first, float second) {
    std::ofstream stream(folder_ / name, std::ios::binary);
    const auto put = [&](auto value) { stream.write(reinterpret_cast<const char*>(&value), sizeof value); };
    stream << "VOL" << '\3';
    for (const std::int32_t value : {1, 2, 1, 1, 1}) put(value);
    for (const float value : {0.0f, 0.0f, 0.0f, 4.0f, 1.0f, 1.0f, first, second}) put(value);
  }

  void TearDown() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ = [] {
    auto folder = std::filesystem::temp_directory_path() / ("aerosol_grid_volume_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    return folder;
  }();
  std::unique_ptr<shading::Services> services_;
  float frame_ = 0;
  Registry registry_;
  scene::Volume volume_;
  Diagnostics warnings_;
};

/// steps.vdb has voxels 0 to 3 of size 0.5, two more on each side that interpolation may reach.
TEST_F(GridVolumes, BoxAroundTheVoxels) {
  const auto made = make("steps.vdb", "density");
  ASSERT_TRUE(made) << format(made.errors());
  const Box<Object> object = (*made)->objectBounds();
  EXPECT_NEAR(object.lower.x, -1, 1e-6);
  EXPECT_NEAR(object.upper.z, 2.5, 1e-6);
  const Box<World> world = (*made)->worldBounds();
  EXPECT_NEAR(world.lower.x, 8, 1e-5);
  EXPECT_NEAR(world.upper.x, 15, 1e-5);
  EXPECT_NEAR(world.upper.y, 5, 1e-5);
  accel::IntervalList intervals;
  Ray<World> ray;
  ray.origin = {0, 1, 1};
  ray.direction = {1, 0, 0};
  (*made)->intersect(ray, intervals);
  ASSERT_EQ(intervals.size(), 1u);
  EXPECT_NEAR(intervals[0].t0, 8, 1e-9);
  EXPECT_NEAR(intervals[0].t1, 15, 1e-9);
  ray.origin = {0, 6, 1};
  intervals.clear();
  (*made)->intersect(ray, intervals);
  EXPECT_TRUE(intervals.empty());
}

TEST_F(GridVolumes, SeveralGridsTogether) {
  const auto made = make("steps.vdb", "density, velocity");
  ASSERT_TRUE(made) << format(made.errors());
  EXPECT_NEAR((*made)->worldBounds().upper.x, 15, 1e-5);
}

TEST_F(GridVolumes, DenseFiles) {
  writeDense("two.vol", 3, 5);
  const auto made = make("two.vol", "");
  ASSERT_TRUE(made) << format(made.errors());
  // Voxels of length 2, two more on each side.
  EXPECT_NEAR((*made)->objectBounds().lower.x, -3, 1e-5);
  EXPECT_NEAR((*made)->objectBounds().upper.x, 7, 1e-5);
  std::string message;
  const VoxelFile* file = services_->voxels("two.vol", message);
  ASSERT_TRUE(file) << message;
  const float x[] = {0.1f, 1, 2, 3, 3.9f}, half[] = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
  float values[5];
  file->grids()[0]->sample(VoxelInterpolation::trilinear, 5, x, half, half, values);
  const float expected[] = {3, 3, 4, 5, 5};  // The outermost values hold up to the faces.
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(values[i], expected[i], 1e-6) << i;
  std::filesystem::resize_file(folder_ / "two.vol", 52);
  const auto cut = make("two.vol", "");
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.errors().entries()[0].location.line, 7);
  EXPECT_NE(format(cut.errors()).find("ends too early"), std::string::npos);
}

/// Around them stand blocks of voxels none of which is active.
TEST_F(GridVolumes, RangesOfDenseFilesAreOfTheirPlace) {
  writeDense("two.vol", 3, 5);
  ASSERT_TRUE(make("two.vol", ""));
  std::string message;
  const VoxelFile* file = services_->voxels("two.vol", message);
  ASSERT_TRUE(file) << message;
  const VoxelGrid& grid = *file->grids()[0];
  const auto expectRange = [&](double begin, double end, float least, float greatest) {
    const VoxelRange range = grid.range(VoxelInterpolation::nearest, {begin, 0.2, 0.2}, {end, 0.8, 0.8}, 0);
    EXPECT_EQ(range.least, least) << begin;
    EXPECT_EQ(range.greatest, greatest) << begin;
  };
  expectRange(0.2, 1.8, 3, 3);
  expectRange(0.2, 3, 3, 5);
  expectRange(2.2, 3.8, 5, 5);
  expectRange(300, 301, 0, 0);
}

TEST_F(GridVolumes, NumberedFiles) {
  writeDense("f.0006.vol", 1, 1);
  writeDense("f.0007.vol", 1, 1);
  frame_ = 7;  // The offset of -1 makes 6 of it.
  EXPECT_TRUE(make("f.%04d.vol", ""));
  frame_ = 7.5f;
  EXPECT_TRUE(make("f.%04d.vol", ""));
  frame_ = 8.5f;
  const auto missing = make("f.%04d.vol", "");
  ASSERT_FALSE(missing);
  EXPECT_NE(format(missing.errors()).find("f.0008.vol"), std::string::npos);
  EXPECT_FALSE(make("f.%s.vol", ""));
  EXPECT_FALSE(make("f.%04d.%d.vol", ""));
}

TEST_F(GridVolumes, ValuesThatAreNoNumbersAreReported) {
  writeDense("bad.vol", std::numeric_limits<float>::quiet_NaN(), 1);
  ASSERT_TRUE(make("bad.vol", ""));
  ASSERT_EQ(warnings_.entries().size(), 1u);
  EXPECT_EQ(warnings_.entries()[0].location.line, 7);
  // The value around the box, which repeats it, is not another one.
  EXPECT_NE(format(warnings_).find("holds 1 values that are no number and 0 infinite"), std::string::npos);
}

TEST_F(GridVolumes, AbsurdSizes) {
  writeDense("huge.vol", 1, 1);
  std::fstream stream(folder_ / "huge.vol", std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(8);
  const std::int32_t huge = 0x7fffffff;
  stream.write(reinterpret_cast<const char*>(&huge), 4);
  stream.close();
  const auto made = make("huge.vol", "");
  ASSERT_FALSE(made);
  EXPECT_NE(format(made.errors()).find("makes no sense"), std::string::npos);
}

TEST_F(GridVolumes, WhatIsWrongIsSaid) {
  const auto none = make("none.vdb", "");
  ASSERT_FALSE(none);
  EXPECT_NE(format(none.errors()).find("none.vdb"), std::string::npos);
  const auto smoke = make("steps.vdb", "smoke");
  ASSERT_FALSE(smoke);
  EXPECT_EQ(smoke.errors().entries()[0].location.line, 7);
  EXPECT_NE(format(smoke.errors()).find("it has 'density' 'velocity'"), std::string::npos);
}

}  // namespace
}  // namespace aerosol::render

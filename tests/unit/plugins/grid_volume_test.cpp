// Volumes of voxel grids: where they are, and what is wrong with their files.

#include <gtest/gtest.h>

#include "core/accel/volume_shape.h"
#include "core/render/registry.h"
#include "plugins/registration.h"

namespace aerosol::render {
namespace {

class GridVolumes : public testing::Test {
 protected:
  void SetUp() override { registerPlugins(registry_); }

  Result<std::unique_ptr<const accel::VolumeShape>> make(const std::string& file, const std::string& grid) {
    volume_.type = "grid";
    volume_.parameters = {{"filename", file}, {"grid", grid}};
    volume_.origin.location = {"scene.xml", 7, 5};
    const std::vector<std::filesystem::path> folders = {AEROSOL_SOURCE_DIR "/tests/language/textures"};
    const Transform<World, Object> toWorld({{{2, 0, 0, 10}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}}},
                                           {{{0.5, 0, 0, -5}, {0, 0.5, 0, 0}, {0, 0, 0.5, 0}, {0, 0, 0, 1}}});
    return registry_.volume("grid")->make({volume_, toWorld, folders, warnings_});
  }

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

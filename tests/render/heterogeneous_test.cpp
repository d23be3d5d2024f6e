#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/render/film_checks.h"

// Media fed by voxels laid into a box, against integrals of what lies between the voxels.

namespace aerosol::test {
namespace {

/// Mitsuba's file of 2 × 1 × 1 voxels with values of one or three channels; its own box is [0, 4] × [0, 1] × [0, 1].
void writeVoxels(const std::filesystem::path& path, const std::vector<float>& first, const std::vector<float>& second) {
  std::ofstream stream(path, std::ios::binary);
  const auto put = [&](auto number) { stream.write(reinterpret_cast<const char*>(&number), sizeof number); };
  stream << "VOL" << '\3';
  for (const std::int32_t number : {1, 2, 1, 1, static_cast<std::int32_t>(first.size())}) put(number);
  for (const float number : {0.0f, 0.0f, 0.0f, 4.0f, 1.0f, 1.0f}) put(number);
  for (const float number : first) put(number);
  for (const float number : second) put(number);
}

class Heterogeneous : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    writeVoxels(folder_ / "density.vol", {0.2f}, {1});
    writeVoxels(folder_ / "color.vol", {0.2f, 0.3f, 0.4f}, {1, 0.8f, 0.6f});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string voxels(const char* file, const std::string& options) const {
    return fmt::format(R"(<volume name="sigma_t" type="gridvolume"><string name="filename" value="{}/{}"/>{}</volume>)",
                       folder_.string(), file, options);
  }

  /// What is left of the sky, seen along +x through a box of glassless walls from (-2, -2, -2) to (2, 2, 2).
  void expectOpticalDepth(const std::string& sigma, Color depth, const char* distance) {
    SCOPED_TRACE(sigma + distance);
    const TestScene scene = loadScene(
        "", {.origin = "-10, 0, 0", .fov = 0.01, .width = 4, .height = 4},
        fmt::format(
            R"(<emitter type="constant"/><shape type="cube"><transform name="to_world"><scale value="2"/></transform>
            <bsdf type="null"/><medium name="interior" type="heterogeneous">{}<rgb name="albedo" value="0"/>
            <float name="scale" value="0.5"/><string name="distance" value="{}"/><float name="step_size" value="0.05"/>
            <phase type="isotropic"/></medium></shape>)",
            sigma, distance));
    ASSERT_TRUE(scene.scene());
    const auto left = [&](const Ray<World>&) {
      return Color(std::exp(-0.5f * depth.r), std::exp(-0.5f * depth.g), std::exp(-0.5f * depth.b));
    };
    EXPECT_TRUE(shows(scene, *scene.render(4096), left, 0.008));
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("aerosol_heterogeneous_" + std::to_string(getpid()));
};

/// The unit cube over the whole shape: half a voxel of each value at the ends, a straight line between.
const std::string overShape =
    R"(<transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/><scale value="4"/></transform>)";

TEST_F(Heterogeneous, IsInterpolatedOverItsBox) {
  expectOpticalDepth(voxels("density.vol", overShape), Color(4 * 0.6f), "auto");
  expectOpticalDepth(voxels("color.vol", overShape), Color(4 * 0.6f, 4 * 0.55f, 4 * 0.5f), "marching");
}

/// A box from x = -1 to 1 and far on the other axes; outside of it there is nothing.
TEST_F(Heterogeneous, EndsAtItsBox) {
  const std::string place = R"(<transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/>
      <scale x="2" y="20" z="20"/></transform>)";
  expectOpticalDepth(voxels("density.vol", place), Color(2 * 0.6f), "auto");
  expectOpticalDepth(voxels("density.vol", place + R"(<string name="filter_type" value="nearest"/>)"), Color(1.2f),
                     "auto");
}

/// Of the file's box, x in [0, 4], the shape holds the half with the first voxel and half of the way to the second.
TEST_F(Heterogeneous, MayUseTheBoxOfTheFile) {
  const std::string place = R"(<boolean name="use_grid_bbox" value="true"/>
      <transform name="to_world"><translate x="0" y="-0.5" z="-0.5"/></transform>)";
  expectOpticalDepth(voxels("density.vol", place), Color(0.2f + (0.2f + 0.6f) / 2), "marching");
}

/// A wall that faces the camera, below an even sky, from x = -1 to 1 at z = 0: what it reflects is the volume's colour
/// there, wherever the shape itself has been moved from.
TEST_F(Heterogeneous, ColoursSurfacesWhereTheyAre) {
  const auto wall = [&](const std::string& texture) {
    return loadScene("", {.fov = 20},
                     fmt::format(R"(<emitter type="constant"/><shape type="rectangle"><transform name="to_world">
        <rotate y="1" angle="180"/><scale value="3"/></transform><bsdf type="diffuse">{}</bsdf></shape>)",
                                 texture));
  };
  const auto shape = [&](const std::string& options) {
    return fmt::format(R"(<texture name="reflectance" type="volume"><volume name="volume" type="gridvolume">
        <string name="filename" value="{}/color.vol"/>{}</volume></texture>)",
                       folder_.string(), options);
  };
  const TestScene scene = wall(shape(
      R"(<transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/><scale x="2" y="20" z="20"/></transform>)"));
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>& ray) {
    const float x = ray.at(5 / ray.direction.z).x, along = std::clamp(x + 0.5f, 0.0f, 1.0f);
    return Color(0.2f, 0.3f, 0.4f) * (1 - along) + Color(1, 0.8f, 0.6f) * along;
  }));
  const TestScene even =
      wall(R"(<texture type="volume" name="reflectance"><rgb name="volume" value="0.1, 0.5, 0.9"/></texture>)");
  ASSERT_TRUE(even.scene());
  EXPECT_TRUE(shows(even, *even.render(64), [](const Ray<World>&) { return Color(0.1f, 0.5f, 0.9f); }));
}

TEST_F(Heterogeneous, TakesConstantVolumesAndReferences) {
  expectOpticalDepth(R"(<volume name="sigma_t" type="constvolume"><rgb name="value" value="0.1, 0.2, 0.3"/></volume>)",
                     Color(0.4f, 0.8f, 1.2f), "auto");
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include <cmath>

#include "core/grid/grid_writer.h"
#include "core/render/prepared_scene.h"
#include "tests/render/film_checks.h"
#include "tests/support/scratch_folder.h"

// Voxels coarser than their file's. The file has planes of 0 and 2 in turn across x, one voxel thick: with half of the
// resolution all of it is 1. So light that crosses it along y arrives as exp(-1) per unit where coarse voxels are seen,
// and half of it as 1, half as exp(-2) per unit, where those of the file are.

namespace aerosol::test {
namespace {

class LevelOfDetail : public ::testing::Test {
 protected:
  LevelOfDetail() {
    grid::NewGrid planes{"density", 1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, {}, true, {}};
    for (std::int32_t i = 0; i < 16; ++i) {
      grid::VoxelBlock block{{8 * (i & 3), 0, 8 * (i >> 2)}, std::vector<float>(512)};
      for (std::size_t k = 0; k < 512; ++k) block.values[k] = (k >> 6 & 1u) != 0 ? 2.0f : 0.0f;
      planes.blocks.push_back(std::move(block));
    }
    EXPECT_FALSE(grid::writeGrids(path_, {&planes, 1}, false).hasErrors());
  }

  /// 8 voxels are 1 long along y, and 8 along x and z.
  std::string slab() const {
    return fmt::format(R"(<volume type="grid"><transform name="to_world"><translate x="-16" y="-4" z="-16"/>
        <scale x="1" y="0.125" z="1"/></transform><string name="filename" value="{0}"/>
        <medium type="grid"><string name="filename" value="{0}"/><string name="interp" value="closest"/>
        <float name="density" value="2"/><float name="scale" value="0.5"/><rgb name="albedo" value="0"/></medium>
        </volume>)",
                       path_);
  }

  ScratchFolder scratch_;
  std::string path_ = (scratch_.path() / "planes.vdb").string();
};

constexpr const char* sky = R"(<emitter type="constant"/>)";

/// Downwards from a height, without perspective: each of 2 x 2 pixels is 4 wide.
TestSensor downFrom(double y) {
  return {.width = 2,
          .height = 2,
          .type = "orthographic",
          .placement = fmt::format(R"(<transform name="to_world"><scale x="4" y="4"/>
              <lookat origin="0, {}, 0" target="0, -9, 0" up="0, 0, 1"/></transform>)",
                                   y)};
}

const double fine = 0.5 * (1 + std::exp(-2.0)), coarse = std::exp(-1.0);

::testing::AssertionResult shows(const TestScene& scene, double value) {
  return shows(scene, *scene.render(16384), [=](const Ray<World>&) { return Color(static_cast<float>(value)); }, 0.02);
}

TEST_F(LevelOfDetail, IsThatOfTheFileByDefault) {
  const TestScene scene = loadScene("", downFrom(9), sky + slab());
  ASSERT_TRUE(scene.scene());
  EXPECT_FALSE(scene.scene()->hasCoarseVolumes);
  EXPECT_TRUE(shows(scene, fine));
}

TEST_F(LevelOfDetail, DistantVoxelsAreCoarser) {
  // A pixel is 4 voxels long.
  const TestScene scene = loadScene(R"(<float name="lod_pixels" value="0.5"/>)", downFrom(9), sky + slab());
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, coarse));
  const TestScene close = loadScene(R"(<float name="lod_pixels" value="0.3"/>)", downFrom(9), sky + slab());
  ASSERT_TRUE(close.scene());
  EXPECT_TRUE(shows(close, fine));
}

TEST_F(LevelOfDetail, LongPathsSeeCoarserVoxels) {
  // A mirror shows the slab from below.
  const std::string mirror = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="20"/><translate y="-3"/></transform>
      <bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>)";
  for (const int depth : {1, 2}) {
    const TestScene scene =
        loadScene(fmt::format(R"(<integer name="lod_depth" value="{}"/>)", depth), downFrom(-1), slab() + mirror + sky);
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(shows(scene, depth == 1 ? coarse : fine));
  }
}

TEST_F(LevelOfDetail, ShadowRaysSeeWhatTheNextSegmentSees) {
  // A white ground under the slab, lit from straight above: the shadow ray is the path's second segment.
  const std::string ground = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="6"/><translate y="-3"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>
      </shape><emitter type="directional"><vector name="direction" x="0" y="-1" z="0"/>
      <rgb name="irradiance" value="3.14159265"/></emitter>)";
  for (const int depth : {1, 2}) {
    const TestScene scene =
        loadScene(fmt::format(R"(<integer name="max_depth" value="2"/><integer name="lod_depth" value="{}"/>)", depth),
                  downFrom(-1), ground + slab());
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(shows(scene, depth == 1 ? coarse : fine));
  }
}

TEST_F(LevelOfDetail, TheBiasIsTold) {
  const TestScene scene = loadScene(R"(<integer name="lod_depth" value="1"/>)", downFrom(9), sky + slab());
  ASSERT_TRUE(scene.scene());
  ASSERT_EQ(scene.scene()->media.size(), 2u);
  const std::string& reason = scene.scene()->samplingReasons[1];
  EXPECT_NE(reason.find("its voxels are 2 times as long, which changes the transmittance of lines"), std::string::npos)
      << reason;
}

TEST(LevelOfDetailOff, OtherMediaStayAsTheyAre) {
  const TestScene scene =
      loadScene(R"(<integer name="lod_depth" value="1"/><float name="lod_pixels" value="100"/>)", downFrom(9),
                std::string(sky) + R"(<volume type="sphere"><medium type="wisps"/></volume>)");
  ASSERT_TRUE(scene.scene());
  EXPECT_EQ(scene.scene()->media.size(), 1u);
  EXPECT_FALSE(scene.scene()->hasCoarseVolumes);
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include "core/grid/grid_writer.h"
#include "core/grid/temporal_file.h"
#include "core/render/prepared_scene.h"
#include "tests/render/stills.h"
#include "tests/support/scratch_folder.h"

// Grids of a volume's own file that its shader reads by getattribute, against texture3d, and against closed forms.

namespace aerosol::test {
namespace {

using volume::DistanceMethod;

const std::string cloud = AEROSOL_SOURCE_DIR "/scenes/cloud.vdb";
const std::string sky = R"(<emitter type="constant"/>)";
const std::string depth = R"(<integer name="max_depth" value="3"/>)";
const TestSensor seen{.fov = 22, .width = 12, .height = 12};

std::string gridVolume(const std::string& file, const std::string& medium, const std::string& more = "") {
  return sky +
         fmt::format(R"(<volume type="grid"><string name="filename" value="{}"/>{}{}</volume>)", file, more, medium);
}

/// What takes light away and gives none back: each path has the transmittance of its steps.
const std::string marched = R"(<medium type="by_name"><string name="distance" value="marching"/>
    <float name="step_size" value="0.05"/></medium>)";

/// Two files with a constant density, and a tint in the first.
class GridAttributes : public ::testing::Test {
 protected:
  void writeBox(const std::string& name, float density, bool hasTint) const {
    std::vector<grid::NewGrid> grids;
    const std::array<double, 16> map = {0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 1};
    const auto add = [&](const char* grid, int channels, std::vector<float> value) {
      grid::NewGrid& added = grids.emplace_back(grid::NewGrid{grid, channels, map, {}, false, {}});
      for (const int x : {-8, 0}) {
        for (const int y : {-8, 0}) {
          for (const int z : {-8, 0}) {
            std::vector<float> values;
            for (int v = 0; v < 512; ++v) values.insert(values.end(), value.begin(), value.end());
            added.blocks.push_back({{x, y, z}, std::move(values)});
          }
        }
      }
    };
    add("density", 1, {density});
    if (hasTint) add("tint", 3, {0.5f, 1, 0});
    ASSERT_FALSE(grid::writeGrids(path(name), grids, false).hasErrors());
  }
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }

  ScratchFolder scratch_;
};

/// The same lookup under two names: what is known of the one (its closed form, its bounds) is known of the other.
TEST_F(GridAttributes, AreWhatTexture3dReads) {
  const std::string direct =
      R"(<medium type="grid"><string name="filename" value="{}"/><float name="density" value="100"/>
      <float name="scale" value="0.03"/><rgb name="albedo" value="0.5"/><float name="g" value="0"/>{}</medium>)";
  for (const auto& [method, expected] :
       {std::pair{"", DistanceMethod::analytic}, std::pair{"null", DistanceMethod::nullScattering},
        std::pair{"marching", DistanceMethod::marching}}) {
    const std::string way = *method ? fmt::format(R"(<string name="distance" value="{}"/>)", method) : "";
    const TestScene byName = loadScene(
        depth, seen,
        gridVolume(cloud,
                   fmt::format(R"(<medium type="by_name_alone"><float name="factor" value="3"/>{}</medium>)", way)));
    TestSensor other = seen;
    other.seed = 1;
    const TestScene byFile = loadScene(depth, other, gridVolume(cloud, fmt::format(fmt::runtime(direct), cloud, way)));
    ASSERT_TRUE(byName.scene() && byFile.scene());
    EXPECT_EQ(byName.scene()->media.front().method, expected) << method;
    EXPECT_TRUE(showTheSame(*byName.render(512), *byFile.render(512), 0.02)) << method;
  }
}

/// Straight through the middle of 2 units of extinction.
TEST_F(GridAttributes, BelongToEachVolumesOwnFile) {
  writeBox("a.vdb", 0.3f, true);
  writeBox("b.vdb", 0.8f, false);
  const TestSensor narrow{.fov = 0.01, .width = 4, .height = 4};
  const auto through = [&](const std::string& content, double tau) {
    const TestScene scene = loadScene(R"(<integer name="max_depth" value="1"/>)", narrow, content);
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(
        shows(scene, *scene.render(256), [&](const Ray<World>&) { return Color(static_cast<float>(std::exp(-tau))); }));
  };
  const std::string cut = R"(<string name="interpolation" value="nearest"/>)";
  // Sixteen voxels of a quarter, on a trilinear slope at both ends: 4 units in all.
  through(gridVolume(path("a.vdb"), marched), 4 * 0.3);
  through(gridVolume(path("b.vdb"), marched), 4 * 0.8);
  // Both at once share the shader's kernels.
  through(gridVolume(path("a.vdb"), marched) + gridVolume(path("b.vdb"), marched).substr(sky.size()), 4 * 1.1);
  // What no grid answers is asked of the volume's attributes: 0.125 in the place of its default.
  const std::string unknown = R"(<medium type="by_name"><string name="grid" value="smoke"/>
      <string name="distance" value="marching"/></medium>)";
  through(gridVolume(path("a.vdb"), unknown, cut + R"(<float name="user:other" value="0.125"/>)"), 4 * 0.125);
  through(gridVolume(path("a.vdb"), unknown, cut), 4 * 0.25);
}

/// Albedo by a vector grid: single scattering goes with it.
TEST_F(GridAttributes, OfThreeChannelsAreColors) {
  writeBox("a.vdb", 0.3f, true);
  writeBox("b.vdb", 0.3f, false);
  const auto load = [&](const char* file, int seed) {
    return loadScene(R"(<integer name="max_depth" value="2"/><boolean name="hide_emitters" value="true"/>)",
                     {.fov = 20, .width = 8, .height = 8, .seed = seed},
                     gridVolume(path(file), R"(<medium type="by_name"><rgb name="albedo" value="0.5"/></medium>)"));
  };
  const TestScene tinted = load("a.vdb", 0), plain = load("b.vdb", 1);
  ASSERT_TRUE(tinted.scene() && plain.scene());
  const auto films = std::pair{tinted.render(256), plain.render(256)};
  std::array<double, 3> sums{}, plainSums{};
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (int c = 0; c < 3; ++c) {
        sums[static_cast<std::size_t>(c)] += static_cast<double>(films.first->estimate(x, y).color[c]);
        plainSums[static_cast<std::size_t>(c)] += static_cast<double>(films.second->estimate(x, y).color[c]);
      }
    }
  }
  EXPECT_NEAR(sums[0] / plainSums[0], 0.5, 0.02);
  EXPECT_NEAR(sums[1] / plainSums[1], 1, 0.03);
  EXPECT_EQ(sums[2], 0);
}

/// Between two frames the values are mixed.
TEST_F(GridAttributes, OfTwoFramesAreMixed) {
  writeBox("f.0001.vdb", 0.2f, false);
  writeBox("f.0002.vdb", 0.8f, false);
  for (const auto& [frame, blend, sigma] :
       {std::tuple{1.25, "true", 0.35}, std::tuple{1.25, "false", 0.2}, std::tuple{2.0, "true", 0.8}}) {
    const std::string more =
        fmt::format(R"(<float name="frame" value="{}"/><boolean name="blend" value="{}"/>)", frame, blend);
    const TestScene scene =
        loadScene(R"(<integer name="max_depth" value="1"/>)", {.fov = 0.01, .width = 4, .height = 4},
                  gridVolume(path("f.%04d.vdb"), marched, more));
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(shows(scene, *scene.render(1024),
                      [&](const Ray<World>&) { return Color(static_cast<float>(std::exp(-4 * sigma))); }))
        << frame << blend;
  }
}

/// Curves are read at the time of each path.
TEST_F(GridAttributes, OfGridsInTimeAreThoseOfThePathsTime) {
  grid::TemporalCurves curves;
  curves.name = "density";
  curves.indexToFile = {0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 1};
  curves.times = {0, 1};
  for (const int x : {-8, 0}) {
    for (const int y : {-8, 0}) {
      for (const int z : {-8, 0}) {
        grid::TemporalSamples samples{{x, y, z}, std::vector<float>(1024, 0.1f)};
        std::fill(samples.values.begin() + 512, samples.values.end(), 0.6f);
        curves.add(samples, 0);
      }
    }
  }
  ASSERT_FALSE(grid::writeTemporal(path("a.avt"), {&curves, 1}).hasErrors());
  const TestScene scene =
      loadScene(R"(<integer name="max_depth" value="1"/>)",
                {.fov = 0.01, .width = 4, .height = 4, .medium = shutter(0, 1)}, gridVolume(path("a.avt"), marched));
  ASSERT_TRUE(scene.scene());
  const double mean = (std::exp(-4 * 0.1) - std::exp(-4 * 0.6)) / (4 * 0.5);
  EXPECT_TRUE(shows(scene, *scene.render(4096), [&](const Ray<World>&) { return Color(static_cast<float>(mean)); }));
}

}  // namespace
}  // namespace aerosol::test

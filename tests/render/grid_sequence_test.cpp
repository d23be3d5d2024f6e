#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "core/grid/grid_writer.h"
#include "tests/render/film_checks.h"

// Volumes of numbered voxel files, against the mean of their frames.

namespace aerosol::test {
namespace {

/// A file of Mitsuba's form: one voxel of `value` over [-1, 1] in all three coordinates.
void writeFrame(const std::filesystem::path& path, float value) {
  std::ofstream stream(path, std::ios::binary);
  const auto put = [&](auto number) { stream.write(reinterpret_cast<const char*>(&number), sizeof number); };
  stream << "VOL" << '\3';
  for (const std::int32_t number : {1, 1, 1, 1, 1}) put(number);
  for (const float number : {-1.0f, -1.0f, -1.0f, 1.0f, 1.0f, 1.0f, value}) put(number);
}

class GridSequences : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    writeFrame(folder_ / "f.003.vol", 0.2f);
    writeFrame(folder_ / "f.004.vol", 0.8f);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// A camera that looks along the axis of the voxel, where extinction is what the file says.
  void expectExtinction(double frame, bool blend, double sigma) {
    const std::string parameters =
        fmt::format(R"(<string name="filename" value="{}/f.%03d.vol"/><float name="frame" value="{}"/>
        <float name="frame_offset" value="-10"/>)",
                    folder_.string(), frame + 10);
    const TestScene scene =
        loadScene("", {.fov = 0.01, .width = 4, .height = 4},
                  fmt::format(R"(<emitter type="constant"/><volume type="grid">{}<boolean name="blend" value="{}"/>
        <string name="interpolation" value="nearest"/>
        <medium type="grid_sequence">{}<integer name="blend" value="{}"/><float name="density" value="1"/><string name="distance" value="marching"/>
        <string name="interp" value="closest"/><rgb name="albedo" value="0"/></medium></volume>)",
                              parameters, blend, parameters, blend ? 1 : 0));
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(shows(scene, *scene.render(64),
                      [&](const Ray<World>&) { return Color(static_cast<float>(std::exp(-2 * sigma))); }))
        << frame << ' ' << blend;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("aerosol_sequence_" + std::to_string(getpid()));
};

TEST_F(GridSequences, ShowAFrame) {
  expectExtinction(3, false, 0.2);
  expectExtinction(4, false, 0.8);
  expectExtinction(3.75, false, 0.2);
}

/// Smoke that has gone: nothing is seen, and that is told.
TEST_F(GridSequences, AFrameMayBeEmpty) {
  const std::array grids{grid::NewGrid{"density", 1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, {}, true, {}}};
  ASSERT_FALSE(grid::writeGrids((folder_ / "f.005.vdb").string(), grids, false).hasErrors());
  const std::string file = fmt::format(
      R"(<string name="filename" value="{}/f.%03d.vdb"/><float name="frame" value="5"/>)", folder_.string());
  for (const char* motion : {"", R"(<animation name="to_world"><transform time="0"/><transform time="1">
      <translate x="1"/></transform></animation>)"}) {
    const TestScene scene =
        loadScene("", {.fov = 20, .width = 4, .height = 4, .medium = R"(<float name="shutter_close" value="1"/>)"},
                  fmt::format(R"(<emitter type="constant"/><volume type="grid">{}{}<medium type="grid_sequence">{}
            </medium></volume>)",
                              motion, file, file),
                  {.mayWarn = true});
    ASSERT_TRUE(scene.scene());
    EXPECT_NE(scene.warnings().find("f.005.vdb' has no active voxels: this volume is empty"), std::string::npos)
        << scene.warnings();
    EXPECT_TRUE(shows(scene, *scene.render(16), [](const Ray<World>&) { return Color(1.0f); }));
  }
}

TEST_F(GridSequences, BlendTwo) {
  expectExtinction(3.5, true, 0.5);
  expectExtinction(3.75, true, 0.65);
  expectExtinction(4, true, 0.8);
}

}  // namespace
}  // namespace aerosol::test

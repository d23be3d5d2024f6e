#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "core/app/run.h"
#include "core/grid/grid_file.h"
#include "tests/render/stills.h"
#include "tests/support/scratch_folder.h"

// Voxels in the frustum of a camera, baked and rendered, against the shaders that they are made of.

namespace aerosol::test {
namespace {

namespace fs = std::filesystem;

class Frustums : public ::testing::Test {
 protected:
  void SetUp() override {
    writeCamera("camera.xml", R"(<sensor type="perspective"><transform name="to_world">
      <lookat origin="0.6, 0.3, -4" target="0.1, 0, 0" up="0, 1, 0"/></transform><float name="fov" value="30"/>
      <float name="principal_point_offset_x" value="0.05"/>
      <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/></film></sensor>)");
  }

  void writeCamera(const std::string& name, const std::string& sensor) const {
    std::ofstream(path(name)) << "<scene version=\"3.0.0\">" << sensor << "</scene>";
  }
  app::ExitCode run(const std::string& words, std::string& said) const {
    std::vector<std::string> arguments;
    std::istringstream stream(words);
    for (std::string word; stream >> word;) arguments.push_back(word);
    std::FILE* const out = std::tmpfile();
    app::Console console;
    console.out = console.err = out;
    const app::ExitCode code = app::run("aerosol", arguments, console);
    std::rewind(out);
    said.clear();
    for (int c = std::fgetc(out); c != EOF; c = std::fgetc(out)) said += static_cast<char>(c);
    std::fclose(out);
    return code;
  }
  app::ExitCode bake(const std::string& words, std::string& said) const {
    return run("bake --shader-path " + shaderFolder().string() + " --bounds -1,-1,-1,1,1,1 -q " + words, said);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// A soft ball of the shader, or of a file.
  static std::string scripted(const std::string& place = "") {
    return light + "<volume type=\"box\">" + place + R"(<medium type="drift"><float name="soft" value="1"/>
      <float name="density" value="6"/><rgb name="albedo" value="0.8"/></medium></volume>)";
  }
  std::string baked(const std::string& file, const std::string& more = "") const {
    return light + fmt::format(R"(<volume type="grid"><string name="filename" value="{0}"/>{1}
      <medium type="baked"><string name="filename" value="{0}"/><rgb name="albedo" value="0.8"/></medium></volume>)",
                               path(file), more);
  }

  static constexpr const char* depth = R"(<integer name="max_depth" value="4"/>)";
  inline static const std::string light = R"(<emitter type="constant"><rgb name="radiance" value="0.4"/></emitter>
    <emitter type="directional"><vector name="direction" x="1" y="-1" z="1"/></emitter>)";
  inline static const std::string ball = " --set soft=1 --set density=6 --set albedo=0.8 ";

  ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

TEST_F(Frustums, BakedAndScriptedAgree) {
  const TestSensor sensor{.width = 12, .height = 12};
  const TestScene expected = loadScene(depth, sensor, scripted());
  const auto film = expected.render(1024);
  int seed = 0;
  for (const char* kind : {"linear", "projective"}) {
    std::string said;
    ASSERT_EQ(bake(fmt::format("drift -o {}/{}.vdb --frustum {}/camera.xml --depth {} --voxel 0.012", folder_.string(),
                               kind, folder_.string(), kind) +
                       ball,
                   said),
              app::ExitCode::success)
        << said;
    // By the blocks and by cells over them; seen from another place than that of the bake.
    for (const char* cells : {"0", "40"}) {
      TestSensor other = sensor;
      other.seed = ++seed;
      const TestScene scene = loadScene(
          depth, other,
          baked(fmt::format("{}.vdb", kind), fmt::format(R"(<integer name="overlay_cells" value="{}"/>)", cells)));
      ASSERT_TRUE(scene.scene());
      EXPECT_TRUE(showTheSame(*film, *scene.render(1024))) << kind << ' ' << cells;
    }
  }
}

/// The grid moves while the shutter is open: it turns; the view that it fills opens and slides, as that of a camera
/// which zooms and pans.
TEST_F(Frustums, Moving) {
  std::string said;
  ASSERT_EQ(bake("drift -o " + path("m.vdb") + " --frustum " + path("camera.xml") + " --voxel 0.012" + ball, said),
            app::ExitCode::success)
      << said;
  const TestSensor sensor{.width = 12, .height = 12, .medium = shutter(0, 1)};
  TestSensor other = sensor;
  other.seed = 1;
  for (const char* last : {R"(<rotate z="1" angle="40"/><translate x="0.5" y="0.2"/>)",
                           R"(<matrix value="1.5 0 0.3 0.1  0 0.7 -0.2 0  0 0 1 0.2  0 0 0 1"/>)"}) {
    const std::string motion = fmt::format(R"(<animation name="to_world"><transform time="0"><translate x="-0.5"/>
        </transform><transform time="1">{}</transform></animation>)",
                                           last);
    const TestScene expected = loadScene(depth, sensor, scripted(motion));
    const TestScene scene = loadScene(depth, other, baked("m.vdb", motion));
    ASSERT_TRUE(expected.scene() && scene.scene());
    EXPECT_TRUE(showTheSame(*expected.render(1024), *scene.render(1024))) << last;
  }
}

/// A camera that moves: each frame of a sequence stands in what is seen at its time.
TEST_F(Frustums, FramesOfAMovingCamera) {
  writeCamera("moving.xml", R"(<sensor type="perspective"><animation name="to_world">
      <transform time="0"><lookat origin="0, 0, -4" target="0, 0, 0" up="0, 1, 0"/></transform>
      <transform time="1"><lookat origin="3, 0, -4" target="3, 0, 0" up="0, 1, 0"/></transform></animation>
      <float name="fov" value="60"/></sensor>)");
  std::string said;
  ASSERT_EQ(
      bake("drift -o " + path("f.%d.vdb") + " --frustum " + path("moving.xml") + " --voxel 0.1 --time 0,1,3" + ball,
           said),
      app::ExitCode::success)
      << said;
  EXPECT_EQ(said.find("all frames are the same"), std::string::npos) << said;
  for (int frame = 1; frame <= 3; ++frame) {
    const auto file = grid::readGrids(path(fmt::format("f.{}.vdb", frame)));
    ASSERT_TRUE(file);
    const auto& frustum = (*file)->grids()[0]->info().frustum;
    ASSERT_TRUE(frustum && frustum->eye);
    EXPECT_NEAR((*frustum->eye)[0], 1.5 * (frame - 1), 1e-5);
    EXPECT_NEAR((*frustum->eye)[2], -4, 1e-5);
  }
}

TEST_F(Frustums, SayWhatIsWrong) {
  std::string said;
  writeCamera("flat.xml", R"(<sensor type="orthographic"/>)");
  EXPECT_EQ(bake("drift -o " + path("a.vdb") + " --frustum " + path("flat.xml") + " --voxel 0.1", said),
            app::ExitCode::badInput);
  EXPECT_NE(said.find("an orthographic camera has no frustum"), std::string::npos) << said;
  writeCamera("away.xml", R"(<sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, -5"
      target="0, 0, -9" up="0, 1, 0"/></transform></sensor>)");
  EXPECT_EQ(bake("drift -o " + path("a.vdb") + " --frustum " + path("away.xml") + " --voxel 0.1", said),
            app::ExitCode::badInput);
  EXPECT_NE(said.find("not in front of the camera"), std::string::npos) << said;
  EXPECT_EQ(bake("drift -o " + path("a.vdb") + " --frustum " + path("missing.xml") + " --voxel 0.1", said),
            app::ExitCode::badInput);
  EXPECT_EQ(bake("drift -o " + path("a.vdb") + " --slices 3 --voxel 0.1", said), app::ExitCode::usage);
  EXPECT_FALSE(fs::exists(path("a.vdb")));
}

}  // namespace
}  // namespace aerosol::test

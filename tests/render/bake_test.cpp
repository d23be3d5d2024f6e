#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "core/app/run.h"
#include "core/grid/grid_file.h"
#include "tests/render/stills.h"
#include "tests/support/effort.h"
#include "tests/support/scratch_folder.h"

// aerosol bake: baked media against the shaders that they are made of.

namespace aerosol::test {
namespace {

namespace fs = std::filesystem;

class Bake : public ::testing::Test {
 protected:
  /// Runs the command; its words are separated by blanks. What it says.
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
  void bake(const std::string& words) const {
    std::string said;
    ASSERT_EQ(run("bake --shader-path " + shaderFolder().string() + " " + words, said), app::ExitCode::success) << said;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

const std::string light = R"(<emitter type="constant"><rgb name="radiance" value="0.4"/></emitter>
    <emitter type="directional"><vector name="direction" x="1" y="-1" z="1"/></emitter>)";
const std::string depth = R"(<integer name="max_depth" value="4"/>)";
const std::string box = R"(<volume type="box">)";

TEST_F(Bake, BakedAndScriptedAgree) {
  bake("drift -o " + path("ball.vdb") +
       " --bounds -1,-1,-1,1,1,1 --voxel 0.02 --set soft=1 --set density=6 --set albedo=0.9,0.6,0.3 --threads 2 -q");
  const TestScene scripted = loadScene(depth, {}, light + box + R"(<medium type="drift"><float name="soft" value="1"/>
      <float name="density" value="6"/><rgb name="albedo" value="0.9, 0.6, 0.3"/></medium></volume>)");
  const TestScene baked = loadScene(depth, {.seed = 1},
                                    light + box +
                                        fmt::format(R"(<medium type="baked">
      <string name="filename" value="{}"/><rgb name="albedo" value="0.9, 0.6, 0.3"/></medium></volume>)",
                                                    path("ball.vdb")));
  EXPECT_TRUE(showTheSame(*scripted.render(1024), *baked.render(1024)));
}

TEST_F(Bake, FilesDoNotDependOnThreadsAndAreSparse) {
  const std::string rest = " --bounds -1,-1,-1,1,1,1 --voxel 0.03 --set soft=1 --set radius=0.3 -q";
  bake("drift -o " + path("one.vdb") + rest + " --threads 1");
  bake("drift -o " + path("three.vdb") + rest + " --threads 3");
  const auto one = grid::readGrids(path("one.vdb")), three = grid::readGrids(path("three.vdb"));
  ASSERT_TRUE(one && three);
  const VoxelGridInfo &a = (*one)->grids()[0]->info(), &b = (*three)->grids()[0]->info();
  EXPECT_EQ(a.name, "density");
  EXPECT_EQ(a.activeVoxels, b.activeVoxels);
  EXPECT_EQ(a.indexBounds, b.indexBounds);
  // The ball alone, of a box eight units large: 4/3 π 0.3³ / 0.03³.
  EXPECT_NEAR(static_cast<double>(a.activeVoxels), 4188, 200);
  std::vector<float> x, y, z, values(1000), others(1000);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    x.push_back(2 * randomFloat(1, 0, i) - 1);
    y.push_back(2 * randomFloat(2, 0, i) - 1);
    z.push_back(2 * randomFloat(3, 0, i) - 1);
  }
  (*one)->grids()[0]->sample(VoxelInterpolation::trilinear, 1000, x.data(), y.data(), z.data(), values.data());
  (*three)->grids()[0]->sample(VoxelInterpolation::trilinear, 1000, x.data(), y.data(), z.data(), others.data());
  EXPECT_EQ(values, others);
}

TEST_F(Bake, FramesAndEmission) {
  bake("travelling -o " + path("f.%03d.vdb") + " --bounds -1,-1,-1,1,1,1 --voxel 0.1 --time 0,1,3 --set glow=2 -q");
  for (int frame = 1; frame <= 3; ++frame) {
    const auto file = grid::readGrids(path(fmt::format("f.{:03}.vdb", frame)));
    ASSERT_TRUE(file);
    const VoxelGrid* glow = (*file)->find("emission");
    ASSERT_NE(glow, nullptr);
    const float time = 0.5f * static_cast<float>(frame - 1);
    const float x = 0.1f * std::round(4 * std::cos(3 * time)), y = 0.1f * std::round(4 * std::sin(3 * time)), z = 0;
    float value[3], density;
    glow->sample(VoxelInterpolation::nearest, 1, &x, &y, &z, value);
    (*file)->find("density")->sample(VoxelInterpolation::nearest, 1, &x, &y, &z, &density);
    EXPECT_GT(value[0], 1.8f);
    EXPECT_NEAR(density, 1.5f * value[0], 1e-5f);
  }
}

/// Curved motion: the file of curves, read at each path's time, against the shader that moves by itself.
TEST_F(Bake, TemporalAndScriptedAgree) {
  bake("travelling -o " + path("ball.avt") +
       " --bounds -1,-1,-1,1,1,1 --voxel 0.04 --temporal --error 0.005 --time 0,1,33 -q");
  const TestSensor sensor{.medium = shutter(0, 1)};
  const TestScene scripted = loadScene(depth, sensor, light + box + R"(<medium type="travelling"/></volume>)");
  TestSensor other = sensor;
  other.seed = 1;
  const TestScene baked = loadScene(depth, other,
                                    light + box +
                                        fmt::format(R"(<medium type="baked">
      <string name="filename" value="{}"/><rgb name="albedo" value="0.8"/><float name="g" value="0.2"/>
      <integer name="moving" value="1"/></medium></volume>)",
                                                    path("ball.avt")));
  EXPECT_TRUE(showTheSame(*scripted.render(1024), *baked.render(1024)));
}

/// 256 stills with AEROSOL_WHOLE_TESTS=1, otherwise 24.
TEST_F(Bake, TemporalAgainstStills) {
  bake("travelling -o " + path("ball.avt") +
       " --bounds -1,-1,-0.6,1,1,0.6 --voxel 0.1 --temporal --error 0.01 --time 0,1,9 -q");
  const auto load = [&](double open, double close, int seed) {
    return loadScene(depth, {.width = 12, .height = 12, .seed = seed, .medium = shutter(open, close)},
                     light + box +
                         fmt::format(R"(<medium type="baked"><string name="filename" value="{}"/>
                     <rgb name="albedo" value="0.8"/><integer name="moving" value="1"/></medium></volume>)",
                                     path("ball.avt")));
  };
  int seed = 0;
  const MeanOfStills mean = meanOfStills([&](double t) { return load(t, t, ++seed); }, effort(24, 256), 86);
  EXPECT_TRUE(showsTheMean(*load(0, 1, 0).render(2048), mean));
}

/// A sequence of files, joined, is what the shader gives when it is baked at the same times.
TEST_F(Bake, SequencesAreJoined) {
  const std::string rest = " --bounds -1,-1,-1,1,1,1 --voxel 0.1 --time 0,1,5 -q";
  bake("travelling -o " + path("f.%d.vdb") + rest);
  bake("travelling --temporal --error 0 -o " + path("whole.avt") + rest);
  std::string frames;
  for (int i = 1; i <= 5; ++i) frames += path(fmt::format("f.{}.vdb ", i));
  bake("--temporal --error 0 --time 0,1,5 -q -o " + path("joined.avt") + " " + frames);
  const auto whole = grid::readGrids(path("whole.avt")), joined = grid::readGrids(path("joined.avt"));
  ASSERT_TRUE(whole && joined);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const float x = 2 * randomFloat(1, 0, i) - 1, y = 2 * randomFloat(2, 0, i) - 1, z = 2 * randomFloat(3, 0, i) - 1;
    const float time = 1.2f * randomFloat(4, 0, i) - 0.1f;
    float a, b;
    (*whole)->grids()[0]->sampleAt(VoxelInterpolation::trilinear, 1, &x, &y, &z, &time, &a);
    (*joined)->grids()[0]->sampleAt(VoxelInterpolation::trilinear, 1, &x, &y, &z, &time, &b);
    ASSERT_NEAR(a, b, 1e-6f);
  }
}

TEST_F(Bake, BadCommandsAreRefused) {
  const std::string out = " -o " + path("x.vdb"), bounds = " --bounds -1,-1,-1,1,1,1";
  const std::pair<std::string, const char*> wrong[] = {
      {"cumulus" + out + " --voxel 0.1", "--bounds is needed"},
      {"cumulus" + out + bounds, "--voxel is needed"},
      {"cumulus" + out + bounds + " --voxel 0", "not a number greater than 0"},
      {"cumulus" + out + " --voxel 1 --bounds 1,1,1,-1,1,1", "greater corner first"},
      {"cumulus" + out + bounds + " --voxel 1e-9", "too"},
      {"cumulus" + out + " --voxel 0.1 --bounds -1e30,-1e30,-1e30,1e30,1e30,1e30", "more than can be numbered"},
      {"cumulus -o " + path("x.txt") + bounds + " --voxel 1", "does not end in .vdb"},
      {"cumulus -o " + path("x.vdb") + bounds + " --voxel 1 --temporal", "does not end in .avt"},
      {"nonsense" + out + bounds + " --voxel 1", "nonsense"},
      {"cumulus" + out + bounds + " --voxel 1 --set densiti=3", "densiti"},
      {"diffuse" + out + bounds + " --voxel 1", "volume"},
      {"a.vdb b.vdb" + out, "--temporal"},
      {"a.vdb b.vdb --temporal --time 0,1,3 -o x.avt", "2 files"},
  };
  for (const auto& [words, text] : wrong) {
    std::string said;
    EXPECT_NE(run("bake " + words, said), app::ExitCode::success) << words;
    EXPECT_NE(said.find(text), std::string::npos) << words << "\n" << said;
    EXPECT_FALSE(fs::exists(path("x.vdb"))) << words;
  }
}

}  // namespace
}  // namespace aerosol::test

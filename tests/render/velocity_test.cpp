#include <fmt/format.h>

#include <filesystem>

#include "core/grid/grid_writer.h"
#include "tests/render/stills.h"
#include "tests/support/effort.h"
#include "tests/support/scratch_folder.h"

// Blur by velocity: a streak in closed form, against its translated copy, against stills.

namespace aerosol::test {
namespace {

constexpr const char* whiteSky = R"(<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>)";
const Color sky(1, 2, 0.5f);

/// A box of three units with a medium `drift` inside.
std::string drifting(const std::string& volume, const std::string& medium, const char* distance = "null") {
  return std::string(whiteSky) + R"(<volume type="box"><transform name="to_world"><scale value="3"/></transform>)" +
         volume +
         fmt::format(R"(<medium type="drift"><string name="distance" value="{}"/>
         <float name="step_size" value="0.05"/><float name="radius" value="0.1666666667"/>{}</medium></volume>)",
                     distance, medium);
}

/// What comes through a ball of radius 0.5 and extinction 2 that moves from `from` by `way`, on average.
ExpectedRadiance streak(std::array<float, 3> from, std::array<float, 3> way) {
  return [from, way](const Ray<World>& ray) {
    double sum = 0;
    constexpr int times = 400;
    for (int i = 0; i < times; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / times;
      Ray<World> seen = ray;
      for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        seen.origin[k] -= from[c] + u * way[c];
      }
      const auto [t0, t1] = throughSphere(seen, 0.5);
      sum += std::exp(-2 * (t1 - t0));
    }
    return sky * static_cast<float>(sum / times);
  };
}

struct Streak {
  const char* name;
  std::string volume, medium;
  double open, close;
  std::array<float, 3> from, way;
};

class VelocityBlur : public ::testing::TestWithParam<Streak> {};

/// Position, sign and length: x + (t - reference) v, with v per second, or per frame, or scaled.
INSTANTIATE_TEST_SUITE_P(
    Streaks, VelocityBlur,
    ::testing::Values(Streak{"plain",
                             R"(<string name="velocity" value="velocity"/>)",
                             R"(<vector name="wind" value="1.2, 0, 0"/>)",
                             0,
                             0.5,
                             {0, 0, 0},
                             {0.6f, 0, 0}},
                      Streak{"reference",
                             R"(<string name="velocity" value="velocity"/><float name="reference_time" value="2"/>)",
                             R"(<vector name="wind" value="1, 0.4, 0"/>)",
                             1.75,
                             2.5,
                             {-0.25f, -0.1f, 0},
                             {0.75f, 0.3f, 0}},
                      Streak{"perFrame",
                             R"(<string name="velocity" value="velocity"/><float name="fps" value="24"/>
               <float name="velocity_scale" value="-0.5"/>)",
                             R"(<vector name="wind" value="0.1, 0, 0"/>)",
                             0,
                             0.5,
                             {0, 0, 0},
                             {-0.6f, 0, 0}}),
    [](const auto& info) { return info.param.name; });

/// A narrow view: every pixel sees the ball for a good part of the time.
TEST_P(VelocityBlur, IsTheStreak) {
  const Streak& p = GetParam();
  for (const char* distance : {"null", "marching"}) {
    const TestScene scene =
        loadScene("", {.fov = 7, .medium = shutter(p.open, p.close)}, drifting(p.volume, p.medium, distance));
    EXPECT_TRUE(shows(scene, *scene.render(1024), streak(p.from, p.way))) << distance;
  }
}

/// A still at another time shows the matter elsewhere, and the bounds know where.
TEST(VelocityStill, IsMovedToo) {
  const std::string medium = R"(<medium type="drift"><string name="distance" value="null"/>
      <float name="radius" value="0.2"/><vector name="wind" value="0.8, 0, 0"/></medium></volume>)";
  const TestScene scene = loadScene("", {.fov = 24, .medium = shutter(0.5, 0.5)},
                                    std::string(whiteSky) + R"(<volume type="box"><transform name="to_world">
      <scale value="3"/></transform><string name="velocity" value="velocity"/>)" +
                                        medium);
  const TestScene moved = loadScene("", {.fov = 24, .seed = 1},
                                    std::string(whiteSky) + R"(<volume type="box"><transform name="to_world">
      <scale value="3"/><translate x="0.4"/></transform>)" +
                                        medium);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.film();
  const auto report = scene.renderInto(*film, {.threads = 1, .endSample = 1024});
  EXPECT_TRUE(showTheSame(*film, *moved.render(1024)));
  EXPECT_EQ(report.statistics.trackers.boundViolations, 0u);
}

/// A constant velocity is a translation, with everything that light does.
TEST(VelocityAgainstTransformation, ATranslatedCopy) {
  const std::string depth = R"(<integer name="max_depth" value="4"/>)";
  const std::string light = R"(<emitter type="point"><point name="position" x="0" y="3" z="-3"/>
      <rgb name="intensity" value="20"/></emitter>)";
  const std::string medium = R"(<medium type="drift"><float name="soft" value="1"/><float name="density" value="8"/>
      <float name="radius" value="0.2"/><rgb name="albedo" value="0.9, 0.6, 0.3"/>
      <vector name="wind" value="0.8, 0.3, 0.2"/></medium></volume>)";
  const TestScene blurred =
      loadScene(depth, {.medium = shutter(0, 1)},
                std::string(whiteSky) + light + R"(<volume type="box"><transform name="to_world"><scale value="3"/>
      </transform><string name="velocity" value="velocity"/>)" +
                    medium);
  const TestScene moved = loadScene(depth, {.seed = 1, .medium = shutter(0, 1)},
                                    std::string(whiteSky) + light + R"(<volume type="box">
      <animation name="to_world"><transform time="0"><scale value="3"/></transform>
      <transform time="1"><scale value="3"/><translate value="0.8, 0.3, 0.2"/></transform></animation>)" +
                                        medium);
  EXPECT_TRUE(showTheSame(*blurred.render(2048), *moved.render(2048)));
}

/// Stills, one at a random time of each part of the shutter, of a velocity that differs from place to place: 256 of
/// them with AEROSOL_WHOLE_TESTS=1, otherwise 64.
TEST(VelocityAgainstStills, IsTheirMean) {
  const auto load = [](double open, double close, int seed) {
    return loadScene(
        R"(<integer name="max_depth" value="3"/>)",
        {.fov = 24, .width = 12, .height = 12, .seed = seed, .medium = shutter(open, close)},
        drifting(R"(<string name="velocity" value="velocity"/><float name="reference_time" value="0.5"/>)",
                 R"(<float name="soft" value="1"/><float name="turn" value="1"/><float name="density" value="5"/>
                              <vector name="wind" value="0.5, 0, 0"/><rgb name="albedo" value="0.8"/>)"));
  };
  int seed = 0;
  const MeanOfStills mean = meanOfStills([&](double t) { return load(t, t, ++seed); }, effort(64, 256), 32);
  EXPECT_TRUE(showsTheMean(*load(0, 1, 0).render(2048), mean));
}

/// What fills a primitive to its rim is carried out of it, and nothing comes in from outside: a translation of all of
/// it.
TEST(VelocityAgainstTransformation, MatterLeavesThePrimitive) {
  const std::string medium =
      R"(<medium type="drift"><float name="radius" value="100"/><float name="density" value="1.5"/>
      <rgb name="albedo" value="0.5"/><vector name="wind" value="1.6, 0.5, 0"/>
      <string name="distance" value="{}"/></medium></volume>)";
  const std::string motion = R"(<animation name="to_world"><transform time="0"><scale value="0.5"/></transform>
      <transform time="1"><scale value="0.5"/><translate value="1.6, 0.5, 0"/></transform></animation>)";
  const std::string place = R"(<transform name="to_world"><scale value="0.5"/></transform>
      <string name="velocity" value="velocity"/>)";
  const std::string depth = R"(<integer name="max_depth" value="3"/>)";
  for (const char* shape : {"box", "sphere", "cylinder", "cone"}) {
    for (const char* distance : {"null", "marching"}) {
      const auto load = [&](const std::string& placement, int seed) {
        return loadScene(depth, {.fov = 30, .width = 12, .height = 12, .seed = seed, .medium = shutter(0, 1)},
                         std::string(whiteSky) + fmt::format(R"(<volume type="{}">)", shape) + placement +
                             fmt::format(fmt::runtime(medium), distance));
      };
      const TestScene carried = load(place, 0), moved = load(motion, 1);
      ASSERT_TRUE(carried.scene() && moved.scene());
      EXPECT_TRUE(showTheSame(*carried.render(2048), *moved.render(2048))) << shape << " " << distance;
    }
  }
}

/// A medium that is the same everywhere is so within its primitive alone.
TEST(VelocityAgainstTransformation, ConstantMatterLeavesThePrimitive) {
  const std::string medium = R"(<medium type="blowing"><rgb name="albedo" value="0.5"/>
      <vector name="wind" value="1.6, 0.5, 0"/></medium></volume>)";
  const auto load = [&](const std::string& placement, int seed) {
    return loadScene(R"(<integer name="max_depth" value="3"/>)",
                     {.fov = 30, .width = 12, .height = 12, .seed = seed, .medium = shutter(0, 1)},
                     std::string(whiteSky) + R"(<volume type="box">)" + placement + medium);
  };
  const TestScene carried = load(R"(<transform name="to_world"><scale value="0.5"/></transform>
      <string name="velocity" value="velocity"/>)",
                                 0);
  const TestScene moved = load(R"(<animation name="to_world"><transform time="0"><scale value="0.5"/></transform>
      <transform time="1"><scale value="0.5"/><translate value="1.6, 0.5, 0"/></transform></animation>)",
                               1);
  ASSERT_TRUE(carried.scene() && moved.scene());
  EXPECT_TRUE(showTheSame(*carried.render(2048), *moved.render(2048)));
}

/// A still far from the reference time: the primitive itself is empty.
TEST(VelocityStill, IsWhereItWasCarried) {
  const std::string medium = R"(<medium type="drift"><float name="radius" value="100"/>
      <vector name="wind" value="3, 0, 0"/></medium></volume>)";
  const TestScene still = loadScene("", {.fov = 30, .medium = shutter(0.5, 0.5)},
                                    std::string(whiteSky) + R"(<volume type="box"><transform name="to_world">
      <scale value="0.5"/></transform><string name="velocity" value="velocity"/>)" +
                                        medium);
  const TestScene moved = loadScene("", {.fov = 30, .seed = 1},
                                    std::string(whiteSky) + R"(<volume type="box">
      <transform name="to_world"><scale value="0.5"/><translate x="1.5"/></transform>)" +
                                        medium);
  EXPECT_TRUE(showTheSame(*still.render(1024), *moved.render(1024)));
}

/// Velocities that grow with the distance have no bounds: that is told.
TEST(VelocityStill, WithoutBoundsIsTold) {
  const TestScene scene =
      loadScene("", {.medium = shutter(0, 1)},
                R"(<volume type="box"><string name="velocity" value="velocity"/><medium type="drift">
                <float name="turn" value="3"/></medium></volume>)",
                {.mayWarn = true});
  ASSERT_TRUE(scene.scene());
  EXPECT_NE(scene.warnings().find("nothing bounds this velocity: what it carries beyond ("), std::string::npos)
      << scene.warnings();
}

/// A soft ball of radius 0.5 in voxels of 0.05, and its velocity, stored where the ball is and nowhere else.
void writeBall(const std::string& path, std::array<float, 3> velocity) {
  const std::array<double, 16> map{0.05, 0, 0, 0, 0, 0.05, 0, 0, 0, 0, 0.05, 0, 0, 0, 0, 1};
  grid::NewGrid density{"density", 1, map, {}, true, {}}, moves{"vel", 3, map, {}, false, {}};
  for (int x = -16; x < 16; x += 8) {
    for (int y = -16; y < 16; y += 8) {
      for (int z = -16; z < 16; z += 8) {
        grid::VoxelBlock d{{x, y, z}, {}}, v{{x, y, z}, {}};
        for (int n = 0; n < 512; ++n) {
          const double r = 0.05 * std::hypot(x + n / 64, y + n / 8 % 8, z + n % 8);
          d.values.push_back(static_cast<float>(std::max(0.0, 6 * (1 - r / 0.5))));
          for (const float component : velocity) v.values.push_back(d.values.back() > 0 ? component : 0);
        }
        density.blocks.push_back(std::move(d));
        moves.blocks.push_back(std::move(v));
      }
    }
  }
  const std::array grids{density, moves};
  ASSERT_FALSE(grid::writeGrids(path, grids, false).hasErrors());
}

/// The streak leaves the stored voxels: blocks are where matter is carried, and velocities go on there.
TEST(VelocityGrid, ATranslatedCopy) {
  const ScratchFolder folder;
  const std::string file = (folder.path() / "ball.vdb").string();
  writeBall(file, {1.4f, 0.3f, 0});
  const std::string medium = fmt::format(R"(<medium type="baked"><string name="filename" value="{}"/>
      <rgb name="albedo" value="0.5"/></medium></volume>)",
                                         file);
  const std::string volume = fmt::format(R"(<volume type="grid"><string name="filename" value="{}"/>)", file);
  const std::string depth = R"(<integer name="max_depth" value="3"/>)";
  const TestScene blurred = loadScene(depth, {.fov = 34, .medium = shutter(0, 1)},
                                      std::string(whiteSky) + volume + R"(<string name="velocity_grid" value="vel"/>
      <float name="reference_time" value="0.25"/>)" +
                                          medium);
  const TestScene moved = loadScene(depth, {.fov = 34, .seed = 1, .medium = shutter(0, 1)},
                                    std::string(whiteSky) + volume + R"(
      <animation name="to_world"><transform time="0"><translate value="-0.35, -0.075, 0"/></transform>
      <transform time="1"><translate value="1.05, 0.225, 0"/></transform></animation>)" +
                                        medium);
  EXPECT_TRUE(showTheSame(*blurred.render(2048), *moved.render(2048)));
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include <array>
#include <fstream>

#include "tests/render/film_checks.h"
#include "tests/support/scratch_folder.h"

// Surface-defined media that overlap: priorities, indices and interiors against closed forms.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>)";
const Color skyColor(1, 2, 0.5f);
constexpr const char* manyBounces =
    R"(<integer name="max_depth" value="2000"/><integer name="rr_depth" value="2000"/>)";

std::string ball(double x, double z, double radius, double ior, int priority, const std::string& more = "") {
  return fmt::format(R"(<shape type="sphere"><point name="center" x="{}" y="0" z="{}"/><float name="radius" value="{}"/>
      <bsdf type="dielectric"><float name="ior" value="{}"/><integer name="priority" value="{}"/>{}</bsdf></shape>)",
                     x, z, radius, ior, priority, more);
}

/// A box across the view between two depths, with the index of air.
std::string layer(double z0, double z1, int priority, const char* color) {
  return fmt::format(R"(<shape type="cube"><transform name="to_world"><scale x="50" y="50" z="{}"/>
      <translate x="0" y="0" z="{}"/></transform><bsdf type="dielectric"><float name="ior" value="1"/>
      <float name="transmission_depth" value="1"/><rgb name="transmission_color" value="{}"/>
      <integer name="priority" value="{}"/></bsdf></shape>)",
                     (z1 - z0) / 2, (z0 + z1) / 2, color, priority);
}

TEST(NestedMedia, FourDielectricsLoseAndMakeNoLight) {
  const std::string balls = ball(0, 0, 1.4, 1.33, 1) + ball(0.5, 0, 0.8, 1.5, 3) + ball(-0.4, 0.2, 0.7, 2.4, 2) +
                            ball(0.1, -0.3, 0.5, 1.1, 4);
  const TestScene scene = loadScene(manyBounces, {.fov = 40}, std::string(sky) + balls);
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return skyColor; }));
}

/// Bodies without priority that overlap, left in the order in which they were entered, and one with a priority.
TEST(NestedMedia, OverlappingBodiesWithoutPriorityLoseAndMakeNoLight) {
  for (const char* more : {"", "ball"}) {
    const std::string balls =
        ball(0, 0, 1.2, 1.5, 0) + ball(0.6, 0.2, 1, 1.33, 0) + (*more ? ball(-0.3, -0.5, 0.8, 1.8, 2) : std::string());
    const TestScene scene = loadScene(manyBounces, {.fov = 40}, std::string(sky) + balls);
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return skyColor; }));
  }
}

/// A ball of absorbing fog that only bounds it.
std::string fogBall(double x, double z, double radius, double sigma, const std::string& more = "") {
  return fmt::format(R"(<shape type="sphere"><point name="center" x="{}" y="0" z="{}"/><float name="radius" value="{}"/>
      <bsdf type="null"/><medium name="interior" type="homogeneous"><rgb name="sigma_t" value="{}"/>
      <rgb name="albedo" value="0"/></medium>{}</shape>)",
                     x, z, radius, sigma, more);
}

/// The sky behind an optical depth on the axis; the view is narrow.
ExpectedRadiance behind(double depth) {
  return [depth](const Ray<World>&) { return skyColor * static_cast<float>(std::exp(-depth)); };
}
const TestSensor narrow{.fov = 0.05, .width = 4, .height = 4};

/// Where interiors without priority overlap, the one entered last holds; what is left first leaves the other one.
TEST(MediumBoundaries, OverlapAsEnteredLast) {
  // From z = -1 to 0 the first one, to 2 the second.
  const std::string both = fogBall(0, 0, 1, 0.1) + fogBall(0, 1, 1, 0.4);
  const double depth = 1 * 0.1 + 2 * 0.4;
  const TestScene scene = loadScene("", narrow, std::string(sky) + both);
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(scene.scene()->nestsMedia);
  EXPECT_TRUE(shows(scene, *scene.render(16384), behind(depth)));
  // Something else with a priority far away changes nothing.
  const TestScene more = loadScene("", narrow, std::string(sky) + both + ball(40, 0, 1, 1.5, 3));
  EXPECT_TRUE(shows(more, *more.render(16384), behind(depth)));
  // One alone needs no stack.
  EXPECT_FALSE(
      loadScene("", narrow, std::string(sky) + fogBall(0, 0, 1, 0.1) + fogBall(9, 0, 1, 0.1)).scene()->nestsMedia);
}

TEST(MediumBoundaries, TheCameraInsideOfOneIsInItsMedium) {
  const TestScene scene = loadScene("", narrow, std::string(sky) + fogBall(0, -5, 2, 0.3));
  EXPECT_TRUE(shows(scene, *scene.render(16384), behind(0.3 * (2 - 0.01))));
}

/// A surface that says nothing of media leaves them as they are, as in other renderers: glass in fog is full of it.
TEST(MediumBoundaries, GlassInFogLeavesItAsItIs) {
  const std::string clear = R"(<shape type="sphere"><float name="radius" value="0.5"/>
      <bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/></bsdf></shape>)";
  for (const char* priority : {"", R"(<integer name="priority" value="1"/>)"}) {
    const TestScene scene = loadScene(manyBounces, narrow, std::string(sky) + fogBall(0, 0, 2, 0.25, priority) + clear);
    EXPECT_TRUE(shows(scene, *scene.render(16384), behind(1))) << priority;
  }
  const std::string none = R"(<shape type="sphere"><float name="radius" value="0.5"/><bsdf type="null"/></shape>)";
  const TestScene scene = loadScene("", narrow, std::string(sky) + fogBall(0, 0, 2, 0.25) + none);
  EXPECT_TRUE(shows(scene, *scene.render(16384), behind(1)));
}

/// A mesh may have shells within shells: each is entered and left.
/// Boundaries that say nothing of their inside bend light by their own indices, also where the paths keep a stack of
/// media: a ball of dye, as scenes of other renderers have it, alone and in a room of the thinnest fog.
TEST(MediumBoundaries, DielectricsInFogBendLightByThemselves) {
  const std::string dye = R"(<shape type="sphere"><bsdf type="{}"><float name="int_ior" value="1.5"/></bsdf>
      <medium name="interior" type="homogeneous"><rgb name="sigma_t" value="0.3, 0.6, 0.9"/><float name="albedo" value="0"/>
      </medium></shape><emitter type="envmap"><string name="filename" value="{}"/></emitter>)";
  const std::string fog = R"(<shape type="cube"><transform name="to_world"><scale value="9"/></transform>
      <bsdf type="null"/><medium name="interior" type="homogeneous"><float name="sigma_t" value="1e-6"/>
      <float name="albedo" value="0"/></medium></shape>)";
  const ScratchFolder folder;
  const std::string map = (folder.path() / "halves.ppm").string();
  std::ofstream(map) << "P3 2 3 255 255 0 0  0 0 255  0 255 0  255 255 255  90 90 0  0 90 90";
  for (const char* material : {"dielectric", "roughdielectric"}) {
    const std::string content = fmt::format(fmt::runtime(dye), material, map);
    const TestScene alone = loadScene(manyBounces, {.fov = 35}, content);
    const TestScene within = loadScene(manyBounces, {.fov = 35, .seed = 1}, content + fog);
    ASSERT_TRUE(alone.scene() && within.scene());
    EXPECT_FALSE(alone.scene()->nestsMedia.isCalledFor());
    EXPECT_TRUE(within.scene()->nestsMedia.isCalledFor());
    EXPECT_TRUE(showTheSame(*alone.render(512), *within.render(512))) << material;
  }
}

TEST(MediumBoundaries, ShellsOfOneMeshWithinEachOther) {
  const ScratchFolder folder;
  const std::string file = (folder.path() / "shells.obj").string();
  std::ofstream obj(file);
  for (const double half : {1.0, 0.5}) {
    for (int i = 0; i < 8; ++i)
      obj << "v " << (i & 1 ? half : -half) << ' ' << (i & 2 ? half : -half) << ' ' << (i & 4 ? half : -half) << '\n';
  }
  for (int first : {1, 9}) {
    for (const auto& quad :
         {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
      obj << "f " << first + quad[0] << ' ' << first + quad[1] << ' ' << first + quad[2] << ' ' << first + quad[3]
          << '\n';
  }
  obj.close();
  const TestScene scene = loadScene("", narrow,
                                    std::string(sky) + fmt::format(R"(<shape type="obj">
      <string name="filename" value="{}"/><bsdf type="null"/><medium name="interior" type="homogeneous">
      <rgb name="sigma_t" value="0.4"/><rgb name="albedo" value="0"/></medium></shape>)",
                                                                   file));
  EXPECT_TRUE(shows(scene, *scene.render(16384), behind(0.8)));
}

TEST(NestedMedia, TheCameraInsideOfThreeKnowsWhereItIs) {
  const std::string balls = ball(0, -5, 3, 1.33, 1) + ball(0.5, -5, 2, 1.5, 3) + ball(0, -5, 1, 1.2, 2);
  const TestScene scene = loadScene(manyBounces, {.fov = 60}, std::string(sky) + balls);
  ASSERT_TRUE(scene.scene());
  EXPECT_EQ(scene.scene()->initialMedia.size(), 3u);
  EXPECT_EQ(scene.scene()->initialMedia.ior(), 1.5f);
  // Seen from within the index 1.5 all radiance is 1.5² times as large.
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return skyColor * 2.25f; }));
}

/// Straight through two layers that overlap from z = -0.5 to 0.5: there the one of higher priority is.
class Overlaps : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(Overlaps, HaveTheStrongerMedium) {
  const auto [first, second] = GetParam();
  const TestScene scene =
      loadScene(manyBounces, {.fov = 30},
                std::string(sky) + layer(-1, 0.5, first, "0.5, 0.8, 0.9") + layer(-0.5, 1, second, "0.9, 0.4, 0.7"));
  ASSERT_TRUE(scene.scene());
  const Color a(0.5f, 0.8f, 0.9f), b(0.9f, 0.4f, 0.7f);
  // Of equal priorities the one entered first holds until the last exit.
  const double lengthA = first > second ? 1.5 : first < second ? 0.5 : 2;
  EXPECT_TRUE(shows(scene, *scene.render(4096), [&](const Ray<World>& ray) {
    Color expected = skyColor;
    for (int c = 0; c < 3; ++c) {
      const double sigma =
          -std::log(static_cast<double>(a[c])) * lengthA - std::log(static_cast<double>(b[c])) * (2 - lengthA);
      expected[c] *= static_cast<float>(std::exp(-sigma / static_cast<double>(ray.direction.z)));
    }
    return expected;
  }));
}

INSTANTIATE_TEST_SUITE_P(Priorities, Overlaps,
                         ::testing::Values(std::pair(2, 1), std::pair(1, 2), std::pair(1, 1), std::pair(-3, 1),
                                           std::pair(-1, -3)));

/// Fresnel's equations for unpolarised light, cosines by Snell's law.
double transmitted(double n1, double n2, double sine) {
  const double c1 = std::sqrt(1 - sine * sine / (n1 * n1)), c2 = std::sqrt(1 - sine * sine / (n2 * n2));
  const double s = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), p = (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2);
  return 1 - 0.5 * (s * s + p * p);
}

/// How far light moves sideways in a layer; `sine` is that in air.
double shift(double thickness, double n, double sine) { return thickness * sine / std::sqrt(n * n - sine * sine); }

/// Glass from z = -1 to 0 and liquid from `front` to 1, one way or the other round; behind them, at `lightZ`, a narrow
/// light where Snell's law says that the view comes out; the light may lie right on the liquid's back.
struct Modelling {
  const char* name;
  double front;
  bool liquidFirst = false;
  double lightZ = 2;
};

class Modellings : public ::testing::TestWithParam<Modelling> {};

TEST_P(Modellings, BendLightBySnellsLaw) {
  const Modelling& m = GetParam();
  constexpr double glass = 1.5, liquid = 1.33, eyeZ = -5;
  const double sine = std::sin(40 * M_PI / 180);
  const double gap = std::max(m.front, 0.0);
  const double x = shift(-1 - eyeZ, 1, sine) + shift(1, glass, sine) + shift(gap, 1, sine) +
                   shift(1 - gap, liquid, sine) + shift(m.lightZ - 1, 1, sine);
  double throughput = transmitted(1, glass, sine) * transmitted(liquid, 1, sine);
  throughput *= gap > 0 ? transmitted(glass, 1, sine) * transmitted(1, liquid, sine) : transmitted(glass, liquid, sine);
  const auto slab = [](double z0, double z1, double ior, int priority) {
    return fmt::format(R"(<shape type="cube"><transform name="to_world"><scale x="50" y="50" z="{}"/>
        <translate x="0" y="0" z="{}"/></transform><bsdf type="dielectric"><float name="ior" value="{}"/>
        <integer name="priority" value="{}"/></bsdf></shape>)",
                       (z1 - z0) / 2, (z0 + z1) / 2, ior, priority);
  };
  const std::string wall = slab(-1, 0, glass, 20), inside = slab(m.front, 1, liquid, 10);
  // The light is 0.02 wide; the three modellings are farther apart.
  const std::string light =
      fmt::format(R"(<shape type="rectangle"><transform name="to_world"><scale x="0.01" y="1" z="1"/>
      <rotate y="1" angle="180"/><translate x="{}" y="0" z="{}"/></transform>
      <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)",
                  x, m.lightZ);
  const TestScene scene = loadScene(fmt::format(R"(<integer name="max_depth" value="{}"/>)", gap > 0 ? 5 : 4),
                                    {.origin = fmt::format("0, 0, {}", eyeZ),
                                     .target = fmt::format("{}, 0, {}", sine, eyeZ + std::cos(40 * M_PI / 180)),
                                     .fov = 0.01,
                                     .width = 2,
                                     .height = 2},
                                    (m.liquidFirst ? inside + wall : wall + inside) + light);
  EXPECT_TRUE(
      shows(scene, *scene.render(16384), [&](const Ray<World>&) { return Color(static_cast<float>(throughput)); }));
}

INSTANTIATE_TEST_SUITE_P(Liquid, Modellings,
                         ::testing::Values(Modelling{"reachesIn", -0.2}, Modelling{"reachesInReversed", -0.2, true},
                                           Modelling{"fits", 0}, Modelling{"fitsReversed", 0, true},
                                           Modelling{"leavesAGap", 0.1}, Modelling{"stands", 0, false, 1},
                                           Modelling{"standsReversed", 0, true, 1}),
                         [](const auto& info) { return std::string(info.param.name); });

/// Media given by `interior`, with priorities: the stronger holds where two boxes overlap.
TEST(InteriorPriorities, DecideAsThoseOfClosuresDo) {
  const auto box = [](double z0, double z1, int priority, const char* sigma) {
    return fmt::format(R"(<shape type="cube"><transform name="to_world"><scale x="50" y="50" z="{}"/>
        <translate x="0" y="0" z="{}"/></transform><integer name="priority" value="{}"/><bsdf type="null"/>{}</shape>)",
                       (z1 - z0) / 2, (z0 + z1) / 2, priority,
                       *sigma
                           ? fmt::format(R"(<medium name="interior" type="homogeneous"><rgb name="sigma_t" value="{}"/>
                                <rgb name="albedo" value="0"/></medium>)",
                                         sigma)
                           : std::string());
  };
  const auto depth = [](const Ray<World>& ray, double length) {
    return static_cast<float>(std::exp(-length / static_cast<double>(ray.direction.z)));
  };
  const std::string light = R"(<emitter type="constant"/>)";
  const TestSensor sensor{.fov = 30};
  const TestScene stronger = loadScene("", sensor, light + box(-1, 0.5, 2, "0.3") + box(-0.5, 1, 1, "0.7"));
  EXPECT_TRUE(shows(stronger, *stronger.render(2048),
                    [&](const Ray<World>& ray) { return Color(depth(ray, 1.5 * 0.3 + 0.5 * 0.7)); }));
  const TestScene weaker = loadScene("", sensor, light + box(-1, 0.5, 1, "0.3") + box(-0.5, 1, 2, "0.7"));
  EXPECT_TRUE(shows(weaker, *weaker.render(2048),
                    [&](const Ray<World>& ray) { return Color(depth(ray, 0.5 * 0.3 + 1.5 * 0.7)); }));
  // An empty one of high priority clips.
  const TestScene clipped = loadScene("", sensor, light + box(-1, 1, 1, "0.4") + box(-0.5, 0.25, 9, ""));
  EXPECT_TRUE(
      shows(clipped, *clipped.render(2048), [&](const Ray<World>& ray) { return Color(depth(ray, 1.25 * 0.4)); }));
}

/// Volume primitives are clipped where that is asked for: along the view, and along shadow rays.
TEST(Clipping, OfVolumePrimitives) {
  for (const bool clips : {false, true}) {
    const std::string content = fmt::format(R"(
        <shape type="cube"><transform name="to_world"><scale x="50" y="50" z="0.5"/></transform>
        <integer name="priority" value="9"/><boolean name="clip_volumes" value="{}"/><bsdf type="null"/></shape>
        <volume type="box"><transform name="to_world"><scale x="60" y="60" z="1"/></transform>
        <medium type="homogeneous"><rgb name="sigma_t" value="0.5"/><rgb name="albedo" value="0"/></medium></volume>)",
                                            clips);
    const double length = clips ? 1 : 2;
    const TestScene seen = loadScene("", {.fov = 30}, R"(<emitter type="constant"/>)" + content);
    EXPECT_TRUE(shows(seen, *seen.render(2048), [&](const Ray<World>& ray) {
      return Color(static_cast<float>(std::exp(-0.5 * length / static_cast<double>(ray.direction.z))));
    })) << clips;
    // A white floor behind, lit from the front through the same layers.
    const TestScene lit = loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 5}, content + R"(
        <emitter type="directional"><vector name="direction" x="0" y="0" z="1"/><rgb name="irradiance" value="3.14159265"/></emitter>
        <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale value="50"/><translate z="2"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></shape>)");
    EXPECT_TRUE(shows(
        lit, *lit.render(4096),
        [&](const Ray<World>& ray) {
          return Color(static_cast<float>(std::exp(-0.5 * length * (1 + 1 / static_cast<double>(ray.direction.z)))));
        },
        0.004))
        << clips;
  }
}

/// The camera's near plane crosses the face of a box of fog: each path finds out for itself where it begins.
TEST(InitialMedia, AreFoundForEachPath) {
  const TestScene scene = loadScene("", {.origin = "0, 0, -5", .fov = 60, .nearClip = 1}, R"(<emitter type="constant"/>
      <shape type="cube"><transform name="to_world"><scale x="50" y="10" z="50"/><translate x="0" y="-10" z="0"/></transform>
      <integer name="priority" value="1"/><bsdf type="null"/>
      <medium name="interior" type="homogeneous"><rgb name="sigma_t" value="0.05"/><rgb name="albedo" value="0"/></medium></shape>)");
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(scene.scene()->probesMedia);
  EXPECT_TRUE(shows(
      scene, *scene.render(1024),
      [&](const Ray<World>& ray) {
        if (ray.direction.y > 0) return Color(1);
        const double z = 55 / static_cast<double>(ray.direction.z),
                     x = 50 / std::fabs(static_cast<double>(ray.direction.x)),
                     y = 20 / -static_cast<double>(ray.direction.y);
        const double length = std::min({x, y, z}) - static_cast<double>(ray.tMin);
        return Color(static_cast<float>(std::exp(-0.05 * length)));
      },
      0.02));
}

/// Where the near clip plane cuts into a body paths begin in its medium, also in the corners of a wide view, where that
/// plane is far from the camera.
TEST(InitialMedia, BeginAtTheNearClipPlane) {
  struct View {
    double fov, x0, x1;
  };
  for (const View& view : {View{30, -50, 50}, View{150, 12, 16}}) {
    const double fov = view.fov, x0 = view.x0, x1 = view.x1;
    const std::string box = fmt::format(
        R"(<shape type="cube"><transform name="to_world"><scale x="{}" y="50" z="2"/><translate x="{}" y="0" z="-1"/>
        </transform><bsdf type="dielectric"><float name="ior" value="1"/><float name="transmission_depth" value="3"/>
        <rgb name="transmission_color" value="0.5, 0.8, 0.9"/><integer name="priority" value="1"/></bsdf></shape>)",
        (x1 - x0) / 2, (x0 + x1) / 2);
    const TestScene scene =
        loadScene(manyBounces, {.fov = fov, .width = 24, .height = 4, .nearClip = 4.5}, std::string(sky) + box);
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(scene.scene()->probesMedia) << fov;
    EXPECT_TRUE(shows(scene, *scene.render(1024), [&](const Ray<World>& ray) {
      const auto from = [&](double plane, float origin, float direction) {
        return (plane - static_cast<double>(origin)) / static_cast<double>(direction);
      };
      const auto [xNear, xFar] =
          std::minmax({from(x0, ray.origin.x, ray.direction.x), from(x1, ray.origin.x, ray.direction.x)});
      const auto [zNear, zFar] =
          std::minmax({from(-3, ray.origin.z, ray.direction.z), from(1, ray.origin.z, ray.direction.z)});
      const double begin = std::max({static_cast<double>(ray.tMin), xNear, zNear}), end = std::min(xFar, zFar);
      Color expected = skyColor;
      for (int c = 0; c < 3; ++c) {
        const double color = std::array{0.5, 0.8, 0.9}[static_cast<std::size_t>(c)];
        expected[c] *= static_cast<float>(std::pow(color, std::max(0.0, end - begin) / 3));
      }
      return expected;
    })) << fov;
  }
}

/// The camera stands in two boxes whose tops coincide: they are entered in the order of objects, whatever it is. Of
/// equal priorities the first one holds; of none the one entered last.
TEST(InitialMedia, CoincidentTopsAreEnteredInTheOrderOfObjects) {
  const char* const colors[] = {"0.5, 0.8, 0.9", "0.9, 0.4, 0.7"};
  for (const int first : {0, 1}) {
    for (const int priority : {0, 1}) {
      TestSensor sensor = narrow;
      sensor.origin = "0, 0, 0.01";
      sensor.target = "0, 0, 1";
      const TestScene scene = loadScene(manyBounces, sensor,
                                        std::string(sky) + layer(-1, 1 + 1e-3 * first, priority, colors[first]) +
                                            layer(-1, 1 + 1e-3 * (1 - first), priority, colors[1 - first]));
      const int ruling = priority == 1 ? first : 1 - first;
      const Color color = ruling == 0 ? Color(0.5f, 0.8f, 0.9f) : Color(0.9f, 0.4f, 0.7f);
      EXPECT_TRUE(shows(
          scene, *scene.render(16384),
          [&](const Ray<World>&) {
            return skyColor * Color(std::pow(color.r, 0.98f), std::pow(color.g, 0.98f), std::pow(color.b, 0.98f));
          },
          0.02))
          << first << ' ' << priority;
    }
  }
}

/// Exits without entry and double entries change nothing else, and are counted.
TEST(OpenSurfaces, AreCounted) {
  const std::string open =
      R"(<shape type="rectangle"><transform name="to_world"><scale value="20"/><translate z="0"/></transform>
      <bsdf type="dielectric"><float name="ior" value="1"/><integer name="priority" value="1"/></bsdf></shape>)";
  const TestScene scene = loadScene(manyBounces, {.fov = 10, .width = 2, .height = 2}, std::string(sky) + open);
  const auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 8});
  EXPECT_EQ(report.statistics.media.exitsWithoutEntry, 32u);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>&) { return skyColor; }));
}

/// A white floor behind a slab of coloured glass, lit through it by a directional light.
TEST(StraightShadows, OnlyWhereTheMaterialAsks) {
  for (const int asks : {0, 1}) {
    const TestScene scene =
        loadScene(R"(<integer name="max_depth" value="2"/>)", {.origin = "0, 0, 1.5", .target = "0, 0, 5", .fov = 20},
                  fmt::format(R"(
      <emitter type="directional"><vector name="direction" x="0" y="0" z="1"/><rgb name="irradiance" value="3.14159265"/></emitter>
      <shape type="cube"><transform name="to_world"><scale x="30" y="30" z="1"/></transform>
      <bsdf type="dielectric"><float name="transmission_depth" value="1"/><rgb name="transmission_color" value="0.5, 0.8, 0.9"/>
      <rgb name="specular_transmittance" value="0.9"/><integer name="straight_shadows" value="{}"/></bsdf></shape>
      <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale value="50"/><translate z="5"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></shape>)",
                              asks));
    EXPECT_TRUE(shows(scene, *scene.render(16), [&](const Ray<World>&) {
      return asks == 1 ? Color(0.25f, 0.64f, 0.81f) * 0.81f : Color();
    })) << asks;
  }
}

/// A rough boundary lit through itself: shadow rays that begin behind it know what is there.
TEST(ShadowsBehindSurfaces, CrossTheMediaThatAreThere) {
  // A ball of coloured liquid with a rough surface holds a bubble of nothing, bounded by a null surface. Light that
  // comes to the rough face from within has crossed liquid and bubble: by both strategies the same image.
  const std::string content = R"(<emitter type="constant"/>
      <shape type="cube"><transform name="to_world"><scale x="30" y="30" z="1"/></transform>
      <bsdf type="dielectric"><float name="ior" value="1"/><float name="roughness" value="0.5"/>
      <float name="transmission_depth" value="1"/><rgb name="transmission_color" value="0.5"/>
      <integer name="priority" value="1"/></bsdf></shape>
      <shape type="cube"><transform name="to_world"><scale x="30" y="30" z="0.5"/></transform>
      <integer name="priority" value="5"/><bsdf type="null"/></shape>)";
  const TestScene scene = loadScene(manyBounces, {.fov = 10}, content);
  // Without a change of index a rough boundary bends nothing.
  EXPECT_TRUE(shows(
      scene, *scene.render(4096),
      [&](const Ray<World>& ray) {
        return Color(static_cast<float>(std::pow(0.5, 1 / static_cast<double>(ray.direction.z))));
      },
      0.01));
}

}  // namespace
}  // namespace aerosol::test

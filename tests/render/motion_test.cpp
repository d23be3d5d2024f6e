#include <fmt/format.h>

#include <numbers>

#include "tests/render/stills.h"
#include "tests/support/effort.h"

// What moves while the shutter is open: against closed forms, and against the mean of stills.

namespace aerosol::test {
namespace {

constexpr const char* whiteSky = R"(<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>)";
const Color sky(1, 2, 0.5f);

std::string animation(const std::vector<std::pair<double, std::string>>& keys) {
  std::string text = R"(<animation name="to_world">)";
  for (const auto& [time, steps] : keys) text += fmt::format(R"(<transform time="{}">{}</transform>)", time, steps);
  return text + "</animation>";
}

const std::string fromLeftToRight =
    animation({{0, R"(<translate x="-0.7"/>)"}, {1, R"(<translate x="0.9" y="0.2"/>)"}});

/// The part of [0, 1] in which a ball of radius r about c + t v meets the line: |(c + t v - o) x d|² < r².
double timeInBall(const Ray<World>& ray, std::array<double, 3> c, std::array<double, 3> v, double r) {
  const auto cross = [](const std::array<double, 3>& a, Vector<World> b) {
    const double x = static_cast<double>(b.x), y = static_cast<double>(b.y), z = static_cast<double>(b.z);
    return std::array{a[1] * z - a[2] * y, a[2] * x - a[0] * z, a[0] * y - a[1] * x};
  };
  const auto dot = [](const auto& a, const auto& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  for (int i = 0; i < 3; ++i) c[static_cast<std::size_t>(i)] -= static_cast<double>(ray.origin[i]);
  const auto p = cross(c, ray.direction), q = cross(v, ray.direction);
  const double a = dot(q, q), b = dot(p, q), root = b * b - a * (dot(p, p) - r * r);
  if (root <= 0) return 0;
  const double first = (-b - std::sqrt(root)) / a, last = (-b + std::sqrt(root)) / a;
  return std::max(0.0, std::min(last, 1.0) - std::max(first, 0.0));
}

/// The whole sweep in closed form: a black ball hides the sky for the time that it is in front of it.
TEST(TransformationBlur, SweepOfABlackBall) {
  const TestScene scene =
      loadScene("", {.fov = 24, .medium = shutter(0, 1)},
                std::string(whiteSky) + R"(<shape type="sphere"><float name="radius" value="0.5"/>)" + fromLeftToRight +
                    R"(<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></shape>)");
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    return sky * static_cast<float>(1 - timeInBall(ray, {-0.7, 0, 0}, {1.6, 0.2, 0}, 0.5));
  }));
}

/// The length of the line in the ball of radius 0.5 at a time.
double chord(Ray<World> ray, double time) {
  ray.origin.x -= static_cast<float>(-0.7 + 1.6 * time);
  ray.origin.y -= static_cast<float>(0.2 * time);
  const auto [t0, t1] = throughSphere(ray, 0.5);
  return t1 - t0;
}

/// The mean over time of what comes through, primitive and interior of a null surface.
TEST(TransformationBlur, SweepOfATranslucentBall) {
  const auto expected = [](const Ray<World>& ray) {
    double sum = 0;
    constexpr int times = 400;
    for (int i = 0; i < times; ++i) sum += std::exp(-2 * chord(ray, (i + 0.5) / times));
    return sky * static_cast<float>(sum / times);
  };
  const std::string fog = R"(<medium type="homogeneous" {}><rgb name="sigma_t" value="2"/>
      <rgb name="albedo" value="0"/></medium>)";
  const TestScene primitive =
      loadScene("", {.fov = 24, .medium = shutter(0, 1)},
                std::string(whiteSky) + R"(<volume type="sphere"><float name="radius" value="0.5"/>)" +
                    fromLeftToRight + fmt::format(fmt::runtime(fog), "") + "</volume>");
  EXPECT_TRUE(shows(primitive, *primitive.render(1024), expected));
  const TestScene interior = loadScene(
      "", {.fov = 24, .medium = shutter(0, 1)},
      std::string(whiteSky) + R"(<shape type="sphere"><float name="radius" value="0.5"/><bsdf type="null"/>)" +
          fromLeftToRight + fmt::format(fmt::runtime(fog), R"(name="interior")") + "</shape>");
  EXPECT_TRUE(shows(interior, *interior.render(1024), expected));
}

/// The square that a black cube shows turns at an even angle: a corner's path is an arc, not a line.
TEST(TransformationBlur, ATurningCube) {
  const std::string turning = animation({{0, R"(<scale z="0.01" x="0.5" y="0.5"/>)"},
                                         {1, R"(<scale z="0.01" x="0.5" y="0.5"/><rotate z="1" angle="90"/>)"}});
  for (const char* shape : {R"(<shape type="cube">)", R"(<shape type="rectangle">)"}) {
    const TestScene scene = loadScene("", {.origin = "0, 0, -50", .fov = 1.8, .medium = shutter(0.25, 0.75)},
                                      std::string(whiteSky) + shape + turning +
                                          R"(<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></shape>)");
    const auto film = scene.render(1024);
    EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
      const double x = 50 * static_cast<double>(ray.direction.x / ray.direction.z);
      const double y = 50 * static_cast<double>(ray.direction.y / ray.direction.z);
      int covered = 0;
      constexpr int times = 2000;
      for (int i = 0; i < times; ++i) {
        const double angle = (0.25 + 0.5 * (i + 0.5) / times) * std::numbers::pi / 2;
        const double c = std::cos(angle), s = std::sin(angle);
        covered += std::fabs(c * x + s * y) < 0.5 && std::fabs(c * y - s * x) < 0.5;
      }
      return sky * (1 - static_cast<float>(covered) / times);
    })) << shape;
  }
}

/// A shadow on the floor is the sweep of the ball, seen from the light.
TEST(TransformationBlur, ShadowsAreOfThePathsTime) {
  const TestScene scene = loadScene(
      R"(<integer name="max_depth" value="2"/>)", {.origin = "0, 20, 0.01", .fov = 8, .medium = shutter(0, 1)},
      R"(<emitter type="directional"><vector name="direction" x="1" y="-1" z="0"/>
      <rgb name="irradiance" value="4"/></emitter>
      <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="50"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>
      <shape type="sphere"><float name="radius" value="0.6"/>)" +
          animation({{0, R"(<translate x="-8" y="8" z="-0.8"/>)"}, {1, R"(<translate x="-8" y="8" z="0.8"/>)"}}) +
          "</shape>");
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    Ray<World> toLight;
    toLight.origin = ray.at(-ray.origin.y / ray.direction.y);
    toLight.direction = normalize(Vector<World>(-1, 1, 0));
    const double lit = 1 - timeInBall(toLight, {-8, 8, -0.8}, {0, 0, 1.6}, 0.6);
    return Color(static_cast<float>(4 * std::sqrt(0.5) * 0.5 / std::numbers::pi * lit));
  }));
}

/// The camera to the left is the world to the right.
TEST(TransformationBlur, MovingCameraAgainstMovingWorld) {
  const std::string body = R"(<medium type="homogeneous"><rgb name="sigma_t" value="3, 2, 1"/>
      <rgb name="albedo" value="0.8"/></medium></volume>)";
  const auto withCamera = [&](const std::string& placement, const std::string& ball) {
    const std::string xml =
        fmt::format(R"(<scene version="3.0.0"><integrator type="path">
        <integer name="max_depth" value="3"/></integrator><sensor type="perspective">{}{}<float name="fov" value="10"/>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
        <rfilter type="box"/></film><sampler type="independent"><integer name="seed" value="{}"/></sampler></sensor>{}
        <volume type="sphere"><float name="radius" value="0.5"/>{}{}</scene>)",
                    placement, shutter(0, 1), seedOfTest(ball.size()) % 100000, whiteSky, ball, body);
    return TestScene(xml);
  };
  const TestScene camera =
      withCamera(animation({{0, R"(<lookat origin="0.4, 0, -5" target="0.4, 0, 0" up="0, 1, 0"/>)"},
                            {1, R"(<lookat origin="-0.6, 0.1, -5" target="-0.6, 0.1, 0" up="0, 1, 0"/>)"}}),
                 "");
  const TestScene world =
      withCamera(R"(<transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>)",
                 animation({{0, R"(<translate x="-0.4"/>)"}, {1, R"(<translate x="0.6" y="-0.1"/>)"}}));
  EXPECT_TRUE(showTheSame(*camera.render(2048), *world.render(2048)));
}

struct Moved {
  std::string name;
  std::string content;
  std::string integrator = R"(<integer name="max_depth" value="3"/>)";
};

class AgainstStills : public ::testing::TestWithParam<Moved> {};

std::vector<Moved> moved() {
  const std::string swing = animation({{0, R"(<rotate z="1" angle="-30"/><translate x="-0.3"/>)"},
                                       {0.4, R"(<scale x="1.2"/><rotate z="1" angle="40"/>)"},
                                       {1, R"(<rotate x="1" y="1" angle="80"/><translate x="0.3" y="0.1"/>)"}});
  const auto medium = [](const char* distance, const char* more) {
    return fmt::format(R"(<medium type="striped"><string name="distance" value="{}"/><float name="density" value="3"/>
        <float name="step_size" value="0.05"/><rgb name="albedo" value="0.7"/>{}</medium>)",
                       distance, more);
  };
  const std::string light = R"(<emitter type="constant"/><emitter type="directional">
      <vector name="direction" x="1" y="-1" z="1"/></emitter>)";
  const std::string world = R"(<float name="world" value="1"/>)", pulse = R"(<float name="pulse" value="1"/>)";
  std::vector<Moved> all;
  all.push_back({"objectSpace", light + R"(<volume type="box">)" + swing + medium("null", "") + "</volume>"});
  all.push_back({"marching", light + R"(<volume type="sphere">)" + swing + medium("marching", "") + "</volume>"});
  all.push_back(
      {"worldSpace", light + R"(<volume type="sphere">)" + swing + medium("null", world.c_str()) + "</volume>"});
  all.push_back({"timeAlone", light + R"(<volume type="sphere">)" + medium("null", pulse.c_str()) + "</volume>"});
  std::string instances = light;
  for (int i = 0; i < 4; ++i) {
    instances += fmt::format(R"(<volume type="box">{}<medium type="striped"><float name="density" value="{}"/>
        <rgb name="albedo" value="0.{}"/></medium></volume>)",
                             i == 3 ? std::string() : swing, 1 + i, 9 - i);
  }
  all.push_back({"instances", instances});
  all.push_back({"surfaces", light + R"(<shape type="cube">)" + swing +
                                 R"(<bsdf type="diffuse"/></shape><shape type="rectangle"><transform name="to_world">
      <rotate x="1" angle="-90"/><scale value="9"/><translate y="-1.5"/></transform></shape>)"});
  const std::string stretch = animation({{0, R"(<scale x="0.5" y="0.2" z="0.3"/><translate x="-0.4" y="0.9"/>)"},
                                         {1, R"(<scale x="0.2" y="0.6" z="0.3"/><rotate x="1" y="1" angle="80"/>
                                                <translate x="0.4" y="1.1"/>)"}});
  const std::string slide = animation({{0, R"(<scale value="0.3"/><translate x="-0.8" y="1.2"/>)"},
                                       {1, R"(<scale value="0.3"/><translate x="0.8" y="1.2"/>)"}});
  const std::string glow = R"(<emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>)";
  const std::string floor = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="9"/><translate y="-1"/></transform></shape>)";
  // Its noiseless part tells how much the noise of the rest matters.
  const std::string dusk = R"(<emitter type="constant"><rgb name="radiance" value="0.06"/></emitter>)";
  const std::string lit = R"(<integer name="max_depth" value="2"/><boolean name="hide_emitters" value="true"/>)";
  for (const char* shape : {"sphere", "rectangle", "disk", "cylinder", "cube"}) {
    all.push_back({fmt::format("light_{}", shape),
                   floor + dusk + fmt::format(R"(<shape type="{}">)", shape) + stretch + glow, lit});
  }
  all.push_back({"light_ball", floor + R"(<shape type="sphere">)" + slide + glow, lit});
  const std::string room = floor + R"(<volume type="sphere"><medium type="homogeneous">
      <rgb name="sigma_t" value="0.4"/><rgb name="albedo" value="0.7"/></medium></volume>)";
  all.push_back(
      {"light_point", room + R"(<emitter type="point"><rgb name="intensity" value="2"/>)" +
                          animation({{0, R"(<translate x="-0.8" y="1.2"/>)"}, {1, R"(<translate x="0.8" y="1.4"/>)"}}) +
                          "</emitter>"});
  all.push_back({"light_spot", room + R"(<emitter type="spot"><rgb name="intensity" value="4"/>)" +
                                   animation({{0, R"(<rotate x="1" angle="90"/><rotate z="1" angle="-20"/>
                                                     <translate x="-0.4" y="2"/>)"},
                                              {1, R"(<rotate x="1" angle="90"/><rotate z="1" angle="20"/>
                                                     <translate x="0.4" y="2"/>)"}}) +
                                   "</emitter>"});
  std::string many = room;
  for (int i = 0; i < 20; ++i) {
    many +=
        fmt::format(R"(<emitter type="point"><rgb name="intensity" value="0.1"/>{}</emitter>)",
                    animation({{0, fmt::format(R"(<translate x="{}" y="1.2"/>)", 0.1 * i - 1)},
                               {1, fmt::format(R"(<translate x="{}" y="1.4" z="{}"/>)", 0.1 * i - 1, 0.1 * i - 1)}}));
  }
  all.push_back({"light_tree", many});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, AgainstStills, ::testing::ValuesIn(moved()),
                         [](const auto& test) { return test.param.name; });

/// 256 stills with AEROSOL_WHOLE_TESTS=1, otherwise 64.
TEST_P(AgainstStills, IsTheirMean) {
  const auto load = [&](double open, double close, int seed) {
    // Lights are looked at by the floor that they light.
    const char* const eye = GetParam().name.starts_with("light") ? "0, 4, -2" : "0, 0, -5";
    return loadScene(
        GetParam().integrator,
        {.origin = eye, .fov = 34, .width = 12, .height = 12, .seed = seed, .medium = shutter(open, close)},
        GetParam().content);
  };
  const TestScene scene = load(0, 1, 0);
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(scene.scene()->changes);
  int seed = 0;
  const MeanOfStills mean = meanOfStills([&](double t) { return load(t, t, ++seed); }, effort(64, 256), 64);
  EXPECT_TRUE(showsTheMean(*scene.render(4096), mean));
}

/// A picture of one instant is that of the scene as it then stands, to the last bit.
TEST(Shutter, OfNoLengthIsAStill) {
  const auto ball = [](const std::string& placement) {
    return std::string(whiteSky) + R"(<volume type="sphere">)" + placement +
           R"(<medium type="striped"><rgb name="albedo" value="0.5"/></medium></volume>)";
  };
  const TestScene instant = loadScene("", {.medium = shutter(0.5, 0.5)},
                                      ball(animation({{0, R"(<translate x="-1"/>)"}, {1, R"(<translate x="2"/>)"}})));
  const TestScene still = loadScene("", {.medium = shutter(0.5, 0.5)},
                                    ball(R"(<transform name="to_world"><translate x="0.5"/></transform>)"));
  ASSERT_TRUE(instant.scene() && still.scene());
  EXPECT_FALSE(instant.scene()->changes);
  EXPECT_TRUE(identical(*instant.render(8), *still.render(8)));
}

/// An open shutter alone changes no bit.
TEST(Shutter, WithoutMotionCostsNothing) {
  const std::string ball = std::string(whiteSky) + R"(<volume type="sphere">
      <medium type="striped"><rgb name="albedo" value="0.5"/></medium></volume>)";
  const TestScene open = loadScene("", {.medium = shutter(0, 1)}, ball), none = loadScene("", {}, ball);
  EXPECT_TRUE(identical(*open.render(8), *none.render(8)));
}

/// The same bits for every number of lanes and threads.
TEST(Shutter, MotionIsTheSameEverywhere) {
  const std::string content = moved()[4].content;
  const TestSensor sensor{.fov = 34, .width = 12, .height = 12, .sampler = "sobol", .medium = shutter(0, 1)};
  const auto film = loadScene("", sensor, content).render(8);
  EXPECT_TRUE(identical(*film, *loadScene("", sensor, content, {.width = 1}).render(8)));
  const TestScene scene = loadScene("", sensor, content);
  auto parallel = scene.film();
  scene.renderInto(*parallel, {.threads = 3, .endSample = 8, .batchSize = 16});
  EXPECT_TRUE(identical(*film, *parallel));
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include "tests/render/film_checks.h"

// Lights that light some volumes and not others, by every technique that finds light: against scenes in which the
// other lights are missing.

namespace aerosol::test {
namespace {

constexpr const char* single = R"(<integer name="max_depth" value="2"/><boolean name="hide_emitters" value="true"/>)";

std::string point(const std::string& id, double x, double y, double z, const std::string& color) {
  return fmt::format(R"(<emitter type="point" id="{}"><point name="position" x="{}" y="{}" z="{}"/>
      <rgb name="intensity" value="{}"/></emitter>)",
                     id, x, y, z, color);
}

/// A cube of side 2 around (x, 0, z).
std::string box(const std::string& controls, double sigma, double albedo, double x = 0, double z = 0,
                const std::string& id = "box") {
  return fmt::format(R"(<volume type="box" id="{}"><transform name="to_world"><translate x="{}" z="{}"/></transform>{}
      <medium type="homogeneous"><rgb name="sigma_t" value="{}"/><rgb name="albedo" value="{}"/></medium></volume>)",
                     id, x, z, controls, sigma, albedo);
}

std::string varying(const std::string& controls, const std::string& more, double x = 0, double y = 0,
                    const std::string& id = "varying") {
  return fmt::format(R"(<volume type="box" id="{}"><transform name="to_world"><translate x="{}" y="{}"/></transform>{}
      <medium type="ramp"><float name="at_zero" value="0.4"/><float name="slope" value="0.1"/>
      <float name="most" value="0.5"/>{}</medium></volume>)",
                     id, x, y, controls, more);
}

std::string lights(const std::string& names) { return fmt::format(R"(<string name="lights" value="{}"/>)", names); }

/// Both scenes look the same.
void expectEqual(const std::string& integrator, const std::string& a, const std::string& b, std::uint32_t samples,
                 double resolution = 0.006) {
  const TestScene first = loadScene(integrator, {.fov = 30, .width = 8, .height = 8}, a);
  const TestScene second = loadScene(integrator, {.fov = 30, .width = 8, .height = 8, .seed = 1}, b);
  ASSERT_TRUE(first.scene());
  ASSERT_TRUE(second.scene());
  EXPECT_TRUE(showTheSame(*first.render(samples), *second.render(samples), resolution));
}

TEST(LightLinks, LightsAlongRays) {
  const std::string key = point("key", 0.3, 1.2, 0.1, "1, 2, 3"), rim = point("rim", -0.3, 0.4, -0.5, "9");
  expectEqual(single, key + rim + box(lights("key"), 0.5, 0.8), key + box("", 0.5, 0.8), 4096);
}

/// Where volumes overlap each takes its own: what is not lit is as good as black.
TEST(LightLinks, OverlappingVolumes) {
  const std::string key = point("key", 0.3, 1.2, 0.1, "1, 2, 3"), rim = point("rim", -0.3, -1.2, -0.5, "5");
  const std::string both =
      key + rim + box(lights("key, rim"), 0.3, 0.8) + box(lights("rim"), 0.4, 0.6, 0.3, 0, "other");
  // The sum of the two: four parts of the light of the key are seen in the first alone.
  const std::string keyAlone = key + box("", 0.3, 0.8) + box("", 0.4, 0, 0.3, 0, "other");
  const std::string rimAlone = rim + box("", 0.3, 0.8) + box("", 0.4, 0.6, 0.3, 0, "other");
  const auto mean = [](const std::string& content, int seed, double& error) {
    const TestScene scene = loadScene(single, {.fov = 30, .width = 8, .height = 8, .seed = seed}, content);
    const auto film = scene.render(8192);
    double sum = 0, variance = 0;
    for (int i = 0; i < 64; ++i) {
      const render::PixelEstimate pixel = film->estimate(i % 8, i / 8);
      sum += static_cast<double>(pixel.color.g) / 64;
      variance += std::pow(static_cast<double>(pixel.standardError.g) / 64, 2);
    }
    error += variance;
    return sum;
  };
  double variance = 0;
  const double found = mean(both, 0, variance);
  const double expected = mean(keyAlone, 1, variance) + mean(rimAlone, 2, variance);
  EXPECT_LT(std::sqrt(variance), 0.004 * expected);
  EXPECT_LT(std::fabs(found - expected), 4 * std::sqrt(variance)) << found << " of " << expected;
}

/// So many lights that they stand in a hierarchy; those that are linked are few.
TEST(LightLinks, OfMany) {
  std::string all, chosen;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.2 * (i % 8) - 0.7, y = 0.3 * (i / 8 % 5) - 0.6;
    const std::string light = point("l" + std::to_string(i), x, y, 0.1 * (i % 3), i % 2 == 0 ? "1, 2, 3" : "3");
    all += light;
    if (i == 3 || i == 20) chosen += light;
  }
  const std::string lamp = R"(<shape type="cube" id="lamp"><transform name="to_world"><scale value="0.2"/>
      <translate y="1.5"/></transform><emitter type="area"><rgb name="radiance" value="20"/></emitter></shape>)";
  expectEqual(single, all + lamp + box(lights("l3, l20, lamp"), 0.5, 0.8), chosen + lamp + box("", 0.5, 0.8), 8192,
              0.01);
}

TEST(LightLinks, GlowingVolumes) {
  const std::string key = point("key", 0.3, 1.3, 0.1, "0.2");
  const std::string fire = varying("", R"(<rgb name="glow" value="2, 1, 0.5"/>)", 0, 3, "fire");
  const std::string sky = R"(<emitter type="constant" id="sky"><rgb name="radiance" value="0.1"/></emitter>)";
  // The fire is out of sight.
  expectEqual(single, key + sky + fire + box(lights("fire, sky"), 0.6, 0.9), sky + fire + box("", 0.6, 0.9), 8192);
  expectEqual(single, key + fire + box(lights("key"), 0.6, 0.9), key + box("", 0.6, 0.9), 2048);
}

/// A medium that nothing lights, itself included: what it emits is seen, what it scatters is not.
TEST(LightLinks, UnlitGlow) {
  const char* const glow = R"(<rgb name="glow" value="0.6"/>)";
  const auto albedo = [&](const char* value) {
    return fmt::format(R"({}<rgb name="albedo" value="{}"/>)", glow, value);
  };
  expectEqual(R"(<integer name="max_depth" value="2"/>)", varying(lights("none"), albedo("0.9")),
              varying("", albedo("0")), 2048);
}

/// Light that is scattered in another volume first is not direct any more.
TEST(LightLinks, SecondBounce) {
  const std::string key = point("key", 0, 2.5, 0, "4"), scatterer = box("", 0.8, 0.9, 0, 2.5, "scatterer");
  const std::string integrator = R"(<integer name="max_depth" value="3"/><boolean name="hide_emitters" value="true"/>)";
  const TestScene scene =
      loadScene(integrator, {.fov = 10, .width = 4, .height = 4}, key + scatterer + box(lights("none"), 0.6, 0.9));
  ASSERT_TRUE(scene.scene());
  EXPECT_GT(scene.render(64)->estimate(1, 1).color.g, 0.0f);
}

TEST(LightLinks, NothingIsLitThroughAHoldout) {
  const std::string lamp = point("key", 0.1, 0.2, 0, "3");
  const TestScene scene =
      loadScene(single, {.fov = 10, .width = 4, .height = 4},
                R"(<emitter type="constant"/>)" + lamp + box(R"(<boolean name="holdout" value="true"/>)", 0.4, 0.9));
  ASSERT_TRUE(scene.scene());
  // The sky is hidden too.
  EXPECT_EQ(scene.render(256)->estimate(1, 1).color, Color());
}

/// Slabs of glass that hardly bend let a lamp's light through straight; lamps are found by area and by direction.
TEST(StraightShadows, OfAreaLights) {
  const auto scene = [](const char* glass) {
    return fmt::format(R"(
      <shape type="sphere"><point name="center" y="0.5" z="-0.4"/><float name="radius" value="0.8"/>
      <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
      {}<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale value="50"/><translate z="3"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf></shape>)",
                       glass);
  };
  const std::string glass = R"(<shape type="cube"><transform name="to_world"><scale x="30" y="30" z="0.2"/>
      <translate z="1"/></transform><bsdf type="dielectric"><float name="ior" value="1.0001"/>
      <integer name="straight_shadows" value="1"/></bsdf></shape>)";
  const TestSensor sensor{.origin = "0, 0, 1.5", .target = "0, 0, 5", .fov = 20, .width = 8, .height = 8};
  TestSensor other = sensor;
  other.seed = 1;
  const TestScene with = loadScene("", sensor, scene(glass.c_str())), without = loadScene("", other, scene(""));
  ASSERT_TRUE(with.scene());
  ASSERT_TRUE(without.scene());
  EXPECT_TRUE(showTheSame(*with.render(2048), *without.render(2048), 0.006));
}

}  // namespace
}  // namespace aerosol::test

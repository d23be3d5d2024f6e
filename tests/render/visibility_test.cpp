#include <fmt/format.h>

#include "tests/render/film_checks.h"

// Surfaces that some rays do not see, and surfaces that some lights do not light: closed forms, and scenes in which the
// surface, or the light, is left out.

namespace aerosol::test {
namespace {

constexpr const char* direct = R"(<integer name="max_depth" value="2"/>)";
constexpr const char* ground = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
    <scale value="20"/></transform><bsdf type="{}"/>{}</shape>)";
constexpr const char* screen = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
    <scale value="1.5"/><translate y="1.2"/></transform><bsdf type="twosided"><bsdf type="diffuse"/></bsdf>{}</shape>)";
constexpr const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1, 0.7, 0.4"/></emitter>)";
constexpr const char* lamp = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>
    <scale value="0.7"/><translate y="3"/></transform><emitter type="area"><rgb name="radiance" value="5"/></emitter>
    {}</shape>)";

std::string visible(const std::string& kinds) {
  return fmt::format(R"(<string name="visible_to" value="{}"/>)", kinds);
}
std::string put(const char* form, const std::string& a = {}) { return fmt::format(fmt::runtime(form), a); }
std::string groundOf(const std::string& material, const std::string& more = {}) {
  return fmt::format(fmt::runtime(ground), material, more);
}

/// From above, a little aside.
TestSensor sensor() { return {.origin = "0, 5, -6", .fov = 30}; }

struct Mean {
  double value = 0, error = 0;
};

Mean meanOf(const std::string& integrator, const std::string& content, std::uint32_t samples = 256) {
  const TestScene scene = loadScene(integrator, sensor(), content);
  EXPECT_TRUE(scene.scene());
  if (!scene.scene()) return {};
  const auto film = scene.render(samples);
  const render::PixelRect area = film->area();
  Mean mean;
  const auto count = static_cast<double>(area.pixelCount());
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const render::PixelEstimate pixel = film->estimate(x, y);
      mean.value += static_cast<double>(pixel.color.r) / count;
      mean.error += std::pow(static_cast<double>(pixel.standardError.r) / count, 2);
    }
  }
  mean.error = std::sqrt(mean.error);
  return mean;
}

/// Both come from independent numbers.
void expectSame(const Mean& a, const Mean& b) {
  EXPECT_GT(a.value, 0);
  EXPECT_NEAR(a.value, b.value, 4 * std::hypot(a.error, b.error) + 1e-6);
  EXPECT_LT(std::hypot(a.error, b.error), 0.02 * b.value);
}

TEST(Visibility, WhatNoRaySeesIsNotThere) {
  for (const std::string& light : {std::string(sky), put(lamp)}) {
    const std::string rest = light + groundOf("diffuse");
    expectSame(meanOf("", rest + put(screen, visible("none"))), meanOf("", rest));
  }
}

TEST(Visibility, TheCameraAloneMayNotSeeWhatCastsItsShadow) {
  // In direct light the picture is that of the ground below, which a screen out of sight shades as well.
  for (const std::string& light : {std::string(sky), put(lamp)}) {
    const std::string rest = light + groundOf("diffuse");
    const Mean hidden = meanOf(direct, rest + put(screen, visible("shadow, diffuse, reflection, refraction")));
    const Mean shadowOnly = meanOf(direct, rest + put(screen, visible("shadow")));
    const Mean seen = meanOf(direct, rest + put(screen)), open = meanOf(direct, rest);
    // Whether rays that are scattered meet it or only shadow rays do: the same light is kept off.
    expectSame(hidden, shadowOnly);
    EXPECT_LT(hidden.value, 0.97 * open.value);
    EXPECT_GT(std::fabs(hidden.value - seen.value), 0.01 * seen.value);
  }
}

/// Hidden emitters are see-through for the camera, also behind a mask, and light what they light.
TEST(Visibility, HiddenEmittersShowWhatLiesBehindThem) {
  constexpr const char* bowl = R"(<shape type="sphere"><point name="center" x="0" y="1.5" z="-1.8"/>
      <float name="radius" value="0.5"/>{}<bsdf type="diffuse"/>
      <emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>)";
  const std::string veil = R"(<shape type="rectangle"><transform name="to_world"><lookat origin="0, 4, -4.8"
      target="0, 5, -6" up="0, 1, 0"/></transform><bsdf type="mask"><float name="opacity" value="0.3"/>
      <bsdf type="diffuse"/></bsdf></shape>)";
  const std::string hidden = R"(<integer name="max_depth" value="3"/><boolean name="hide_emitters" value="true"/>)";
  const std::string shown = R"(<integer name="max_depth" value="3"/>)";
  for (const std::string& before : {std::string(), veil}) {
    const TestScene a = loadScene(hidden, sensor(), before + put(bowl) + groundOf("diffuse"));
    const TestScene b = loadScene(
        shown, sensor(), before + put(bowl, visible("shadow, diffuse, reflection, refraction")) + groundOf("diffuse"));
    ASSERT_TRUE(a.scene() && b.scene());
    EXPECT_TRUE(identical(*a.render(16), *b.render(16)));
    EXPECT_FALSE(
        identical(*a.render(16), *loadScene(shown, sensor(), before + put(bowl) + groundOf("diffuse")).render(16)));
  }
}

/// Points and directions shine through what paths pass straight, where they are asked to.
TEST(Visibility, LightOfPointsShinesStraightThroughMasksAndPanes) {
  constexpr const char* pane = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="20"/><translate y="2"/></transform><string name="visible_to" value="shadow, diffuse"/>{}</shape>)";
  const std::string mask =
      put(pane, R"(<bsdf type="mask"><float name="opacity" value="0.25"/><bsdf type="diffuse"/></bsdf>)");
  const std::string glass = put(pane, R"(<bsdf type="thindielectric"><float name="int_ior" value="1.5"/>
      <float name="ext_ior" value="1"/></bsdf>)");
  const std::string sun = R"(<emitter type="directional"><vector name="direction" value="0, -1, 0"/>
      <rgb name="irradiance" value="3.14159265"/></emitter>)";
  const std::string passing =
      R"(<integer name="max_depth" value="2"/><boolean name="transparent_shadows" value="true"/>)";
  const std::string floor = groundOf("diffuse");
  EXPECT_NEAR(meanOf(direct, sun + floor).value, 0.5, 1e-4);
  EXPECT_EQ(meanOf(direct, sun + mask + floor).value, 0);
  EXPECT_NEAR(meanOf(passing, sun + mask + floor).value, 0.5 * 0.75, 1e-4);
  EXPECT_NEAR(meanOf(passing, sun + mask + mask + floor).value, 0.5 * 0.75 * 0.75, 1e-4);
  EXPECT_NEAR(meanOf(passing, sun + glass + floor).value, 0.5 * (1 - 0.08 / 1.04), 1e-4);
}

TEST(Visibility, WhatCastsNoShadowTakesNoLightAway) {
  for (const std::string& light : {std::string(sky), put(lamp)}) {
    const std::string rest = light + groundOf("diffuse");
    expectSame(meanOf(direct, rest + put(screen, visible("diffuse, reflection, refraction"))), meanOf(direct, rest));
  }
}

TEST(Visibility, MirrorsShowWhatReflectionsSee) {
  const std::string rest = sky + groundOf("conductor");
  expectSame(meanOf("", rest + put(screen, visible("camera, shadow, diffuse, refraction"))),
             meanOf("", rest + put(screen, visible("camera, shadow, diffuse"))));
  const Mean mirrored = meanOf("", rest + put(screen, visible("reflection, shadow, diffuse")));
  EXPECT_LT(mirrored.value, 0.98 * meanOf("", rest).value);
}

TEST(Visibility, LightsLightTheSurfacesThatNameThem) {
  const std::string lights = std::string(
                                 R"(<emitter type="constant" id="air"><rgb name="radiance" value="0.6"/></emitter>
      <emitter type="point" id="key"><point name="position" x="1" y="2" z="-1"/><rgb name="intensity" value="5"/>
      </emitter>)") + put(lamp, R"(<string name="light_group" value="g"/>)");
  const auto linked = [&](const std::string& names) {
    return meanOf(direct, lights + groundOf("diffuse", fmt::format(R"(<string name="lights" value="{}"/>)", names)));
  };
  const std::string air = R"(<emitter type="constant"><rgb name="radiance" value="0.6"/></emitter>)";
  const std::string key =
      R"(<emitter type="point"><point name="position" x="1" y="2" z="-1"/><rgb name="intensity" value="5"/></emitter>)";
  const std::string dark = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>
      <scale value="0.7"/><translate y="3"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
      </shape>)";
  expectSame(linked("key"), meanOf(direct, key + dark + groundOf("diffuse")));
  expectSame(linked("air"), meanOf(direct, air + dark + groundOf("diffuse")));
  expectSame(linked("air, key"), meanOf(direct, air + key + dark + groundOf("diffuse")));
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include "tests/render/film_checks.h"

// What is set on a volume on top of its medium, against closed forms.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"/>)";
const TestSensor wide{.fov = 40, .width = 12, .height = 12};

/// A volume across the view from z = -1 to 1.
std::string layer(const std::string& controls, const std::string& medium) {
  return fmt::format(
      R"(<volume type="box"><transform name="to_world"><scale x="60" y="60" z="1"/></transform>{}{}</volume>)",
      controls, medium);
}

std::string homogeneous(double sigma, double albedo = 0) {
  return fmt::format(
      R"(<medium type="homogeneous"><rgb name="sigma_t" value="{}"/><rgb name="albedo" value="{}"/></medium>)", sigma,
      albedo);
}

std::string ramp(const char* distance, const char* more = "") {
  return fmt::format(R"(<medium type="ramp"><string name="distance" value="{}"/><float name="step_size" value="0.05"/>
      <float name="at_zero" value="0.4"/><float name="slope" value="0.1"/><float name="most" value="0.5"/>{}</medium>)",
                     distance, more);
}

ExpectedRadiance beyondDepth(double depth) {
  return [=](const Ray<World>& ray) {
    return Color(static_cast<float>(std::exp(-depth / static_cast<double>(ray.direction.z))));
  };
}

TEST(VolumeControls, DensityIsAFactor) {
  const TestScene constant = loadScene("", wide, sky + layer(R"(<float name="density" value="3"/>)", homogeneous(0.2)));
  EXPECT_TRUE(shows(constant, *constant.render(2048), beyondDepth(3 * 0.4)));
  for (const char* distance : {"null", "marching"}) {
    const TestScene scene = loadScene("", wide, sky + layer(R"(<float name="density" value="1.5"/>)", ramp(distance)));
    const auto film = scene.film();
    const auto report = scene.renderInto(*film, {.threads = 1, .endSample = 2048});
    EXPECT_TRUE(shows(scene, *film, beyondDepth(1.5 * 0.8))) << distance;
    EXPECT_EQ(report.statistics.trackers.boundViolations, 0u) << distance;
  }
}

TEST(VolumeControls, DensityRamp) {
  // Extinction s becomes s (0.5 + 1.5 s); ∫ of that for s = 0.4 + 0.1 z.
  const double depth = 0.5 * 0.8 + 1.5 * (0.32 + 0.02 / 3);
  for (const char* distance : {"null", "marching"}) {
    const TestScene scene =
        loadScene("", wide, sky + layer(R"(<string name="density_ramp" value="0: 0.5; 1: 2"/>)", ramp(distance)));
    const auto film = scene.film();
    const auto report = scene.renderInto(*film, {.threads = 1, .endSample = 2048});
    EXPECT_TRUE(shows(scene, *film, beyondDepth(depth))) << distance;
    EXPECT_EQ(report.statistics.trackers.boundViolations, 0u) << distance;
  }
}

TEST(VolumeControls, EmissionIsAFactor) {
  const TestScene scene = loadScene(
      "", wide, layer(R"(<float name="emission" value="2.5"/>)", ramp("null", R"(<rgb name="glow" value="0.6"/>)")));
  // ∫ ε exp(-τ) along a ray, by its own quadrature.
  EXPECT_TRUE(shows(scene, *scene.render(2048), [](const Ray<World>& ray) {
    const double cosine = static_cast<double>(ray.direction.z);
    double sum = 0, depth = 0;
    constexpr int steps = 2000;
    for (int i = 0; i < steps; ++i) {
      const double z = -1 + 2 * (i + 0.5) / steps, length = 2.0 / steps / cosine, sigma = 0.4 + 0.1 * z;
      sum += 2.5 * 0.6 * std::exp(-depth - 0.5 * sigma * length) * length;
      depth += sigma * length;
    }
    return Color(static_cast<float>(sum));
  }));
}

/// A white floor behind the layer, lit through it.
TEST(VolumeControls, ShadowDensity) {
  const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 5},
                                    R"(
      <emitter type="directional"><vector name="direction" x="0" y="0" z="1"/><rgb name="irradiance" value="3.14159265"/></emitter>
      <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale value="50"/><translate z="2"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></shape>)" +
                                        layer(R"(<float name="shadow_density" value="0.25"/>)", homogeneous(0.5)));
  EXPECT_TRUE(shows(
      scene, *scene.render(4096),
      [](const Ray<World>& ray) {
        return Color(static_cast<float>(std::exp(-0.25 - 1 / static_cast<double>(ray.direction.z))));
      },
      0.004));
}

TEST(VolumeControls, HoldoutIsAHole) {
  const TestScene scene =
      loadScene("", wide, sky + layer(R"(<boolean name="holdout" value="true"/>)", homogeneous(0.4, 0.9)));
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(2048);
  EXPECT_TRUE(shows(scene, *film, beyondDepth(0.8)));
  double alpha = 0, expected = 0;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) {
      alpha += static_cast<double>(film->estimate(x, y).alpha) / 144;
      const Ray<World> ray =
          scene.scene()->camera->ray({.x = static_cast<float>(x) + 0.5f, .y = static_cast<float>(y) + 0.5f});
      expected += std::exp(-0.8 / static_cast<double>(ray.direction.z)) / 144;
    }
  }
  EXPECT_NEAR(alpha, expected, 0.004);
}

std::string light(const char* id, const char* color) {
  return fmt::format(R"(<emitter type="directional" id="{}"><vector name="direction" x="0" y="-1" z="0.5"/>
      <rgb name="irradiance" value="{}"/></emitter>)",
                     id, color);
}

TEST(VolumeControls, LightsAreLinked) {
  const std::string medium = homogeneous(0.3, 0.9),
                    glowing = R"(<shape type="sphere" id="lamp"><point name="center" y="3"/>
      <emitter type="area"><rgb name="radiance" value="20"/></emitter></shape>)";
  const std::string integrator = R"(<integer name="max_depth" value="2"/><boolean name="hide_emitters" value="true"/>)";
  const TestScene linked = loadScene(integrator, wide,
                                     light("key", "1, 2, 3") + light("rim", "5") + glowing +
                                         layer(R"(<string name="lights" value="key, lamp"/>)", medium));
  TestSensor other = wide;
  other.seed = 1;
  const TestScene alone = loadScene(integrator, other, light("key", "1, 2, 3") + glowing + layer("", medium));
  EXPECT_TRUE(showTheSame(*linked.render(16384), *alone.render(16384), 0.006));
  const TestScene unlit =
      loadScene(integrator, wide, light("key", "1") + layer(R"(<string name="lights" value="none"/>)", medium));
  EXPECT_EQ(unlit.render(4)->estimate(5, 5).color, Color());
}

}  // namespace
}  // namespace aerosol::test

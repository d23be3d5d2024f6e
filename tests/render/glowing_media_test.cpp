#include <fmt/format.h>

#include <numbers>

#include "tests/render/film_checks.h"

// Media that glow light what is around them: sampled as lights, and met by the paths.

namespace aerosol::test {
namespace {

using std::numbers::pi;

/// The plane y = 0, seen from above and aside; the ball is above it and out of sight.
constexpr const char* plane = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
    <scale value="30"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.5, 0.2"/></bsdf></shape>)";
const TestSensor fromAbove{.origin = "0, 2, -2", .target = "0, 0, 0.2", .fov = 40};
constexpr const char* direct = R"(<integer name="max_depth" value="2"/>)";

/// A ball of radius R that emits ε per length and absorbs nothing lights as its centre would: E = 4π ε R³ cos / 3d².
Color onThePlane(const Ray<World>& ray, double emission) {
  const double t = -static_cast<double>(ray.origin.y) / static_cast<double>(ray.direction.y);
  const double x = static_cast<double>(ray.origin.x) + t * static_cast<double>(ray.direction.x) - 0.3;
  const double z = static_cast<double>(ray.origin.z) + t * static_cast<double>(ray.direction.z) - 0.2;
  const double squared = x * x + 2.5 * 2.5 + z * z, r = 0.4;
  const double irradiance = 4 * pi / 3 * emission * r * r * r * 2.5 / (squared * std::sqrt(squared));
  return Color(0.8f, 0.5f, 0.2f) * static_cast<float>(irradiance / pi);
}

std::string ball(const std::string& medium) {
  return R"(<volume type="sphere"><transform name="to_world"><scale value="0.4"/><translate x="0.3" y="2.5" z="0.2"/></transform>)" +
         medium + "</volume>";
}

TEST(GlowingMedia, AConstantBallLightsAPlane) {
  const TestScene scene =
      loadScene(direct, fromAbove, plane + ball(R"(<medium type="homogeneous"><rgb name="sigma_t" value="0"/>
                    <rgb name="emission" value="3"/></medium>)"));
  EXPECT_TRUE(shows(scene, *scene.render(1024), [](const Ray<World>& ray) { return onThePlane(ray, 3); }, 0.01));
}

/// Its shader gives extinction that varies by next to nothing, and emission that is found by bounds.
std::string varyingBall(const char* method) {
  return ball(fmt::format(R"(<medium type="ramp"><string name="distance" value="{}"/><float name="at_zero" value="0"/>
      <float name="slope" value="1e-7"/><float name="most" value="1e-6"/><rgb name="glow" value="3"/></medium>)",
                          method));
}

TEST(GlowingMedia, AVaryingBallLightsAPlane) {
  for (const char* method : {"auto", "relaxed", "marching"}) {
    const TestScene scene = loadScene(direct, fromAbove, plane + varyingBall(method));
    EXPECT_TRUE(shows(
        scene, *scene.render(1024), [](const Ray<World>& ray) { return onThePlane(ray, 3); }, 0.01))
        << method;
  }
}

TEST(GlowingMedia, AFaultOfTwoPercentIsFound) {
  const TestScene scene = loadScene(direct, fromAbove, plane + varyingBall("relaxed"));
  EXPECT_FALSE(shows(scene, *scene.render(1024), [](const Ray<World>& ray) { return onThePlane(ray, 3.06); }, 0.01));
}

/// In a furnace of emission and absorption at one temperature nothing can be seen, whoever finds the light.
TEST(GlowingMedia, AFurnaceStaysOne) {
  const TestScene scene = loadScene("", {.origin = "0.3, 0.2, -1", .fov = 70}, R"(
      <shape type="sphere"><boolean name="flip_normals" value="true"/><float name="radius" value="2"/>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.4"/></bsdf>
      <emitter type="area"><rgb name="radiance" value="0.6"/></emitter></shape>
      <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="2"/><rgb name="albedo" value="0.7"/>
      <rgb name="emission" value="0.6"/></medium></volume>
      <volume type="box"><transform name="to_world"><scale value="0.5"/><translate x="0.5"/></transform>
      <medium type="homogeneous"><rgb name="sigma_t" value="1"/><rgb name="albedo" value="0.2"/>
      <rgb name="emission" value="0.8"/></medium></volume>)");
  EXPECT_TRUE(shows(scene, *scene.render(1024), [](const Ray<World>&) { return Color(1.0f); }));
}

/// A fire at the floor of a room, as bounds of its shader tell where it may emit: against paths that meet it by chance.
TEST(FireInARoom, LightsItWithAFractionOfTheNoise) {
  const auto wall = [](const char* turn, const char* place) {
    return fmt::format(
        R"(<shape type="rectangle"><transform name="to_world">{}<scale value="2"/><translate {}/></transform>
        <bsdf type="diffuse"/></shape>)",
        turn, place);
  };
  const std::string room =
      wall(R"(<rotate x="1" angle="-90"/>)", R"(y="-2")") + wall(R"(<rotate x="1" angle="90"/>)", R"(y="2")") +
      wall(R"(<rotate y="1" angle="180"/>)", R"(z="2")") + wall(R"(<rotate y="1" angle="90"/>)", R"(x="-2")") +
      wall(R"(<rotate y="1" angle="-90"/>)", R"(x="2")");
  const std::string fire = R"(<volume type="sphere"><transform name="to_world"><scale value="0.3"/>
      <translate x="0.3" y="-1.6"/></transform><medium type="ramp"><string name="distance" value="null"/>
      <float name="at_zero" value="0.5"/><float name="slope" value="0.4"/><float name="most" value="1"/>
      <rgb name="albedo" value="0"/><rgb name="glow" value="20"/></medium></volume>)";
  const TestSensor view{.origin = "0, 0.5, -1.9", .target = "0, 0.8, 2", .fov = 50, .width = 12, .height = 8};
  TestSensor other = view;
  other.seed = 1;
  const std::string depth = R"(<integer name="max_depth" value="4"/>)";
  const TestScene with = loadScene(depth, view, room + fire);
  const TestScene without = loadScene(depth + R"(<boolean name="volume_lights" value="false"/>)", other, room + fire);
  ASSERT_TRUE(with.scene()->lights.hasVolumes());
  ASSERT_FALSE(without.scene()->lights.hasVolumes());
  const auto seen = with.render(256), met = without.render(1024);
  // Few paths meet the fire by chance: pixels have no normal distribution, the mean over all of them has.
  struct Sum {
    double value = 0, variance = 0;
  };
  const auto sum = [&](const render::Film& film) {
    Sum all;
    for (int y = 0; y < view.height; ++y) {
      for (int x = 0; x < view.width; ++x) {
        const render::PixelEstimate p = film.estimate(x, y);
        all.value += static_cast<double>(p.color.g);
        all.variance += std::pow(static_cast<double>(p.standardError.g), 2);
      }
    }
    return all;
  };
  const Sum sampled = sum(*seen), chance = sum(*met);
  const double ratio = 4 * chance.variance / sampled.variance;
  RecordProperty("ratio", fmt::format("{:.0f}", ratio));
  EXPECT_GT(ratio, 20);
  const double error = std::sqrt(sampled.variance + chance.variance);
  EXPECT_LT(error, 0.05 * sampled.value);
  EXPECT_NEAR(sampled.value, chance.value, maximumZ * error);
}

}  // namespace
}  // namespace aerosol::test

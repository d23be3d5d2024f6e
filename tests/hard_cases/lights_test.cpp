#include <fmt/format.h>

#include <numbers>

#include "tests/render/film_checks.h"

// Lights where their irradiance has no limit, and next to there: on a camera ray, at the camera, at the ends of the
// medium, a millionth of a unit beside of the ray.

namespace aerosol::test {
namespace {

constexpr const char* once = R"(<integer name="max_depth" value="2"/>)";

std::string pointLight(const std::string& place, const std::string& more = "") {
  return fmt::format(
      R"(<emitter type="point"><point name="position" {}/><rgb name="intensity" value="2"/>{}</emitter>)", place, more);
}

std::string fog(double sigma) {
  return fmt::format(R"(<volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="{}"/>
      <rgb name="albedo" value="0.9"/></medium></volume>)",
                     sigma);
}

/// One pixel so narrow that all its rays are the same, straight along z.
const TestSensor straight{.fov = 1e-7, .width = 1, .height = 1};

/// Nothing is dropped, and the same comes out twice.
render::PixelEstimate renderSoundly(const TestScene& scene, std::uint32_t samples, std::uint64_t* met = nullptr) {
  auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = samples});
  EXPECT_EQ(film->droppedCount(), 0u);
  EXPECT_TRUE(identical(*film, *scene.render(samples)));
  if (met) *met = report.statistics.raysIntoLights;
  const render::PixelEstimate pixel = film->estimate(0, 0);
  EXPECT_TRUE(isFinite(pixel.color) && isFinite(pixel.standardError));
  return pixel;
}

/// In the middle of the medium and at its ends the radiance is infinite: the estimate is finite, and it is counted.
TEST(LightOnTheRay, InsideTheMediumIsFiniteAndCounted) {
  for (const char* place : {R"(x="0" y="0" z="0")", R"(x="0" y="0" z="-1")", R"(x="0" y="0" z="1")"}) {
    std::uint64_t met = 0;
    const TestScene scene = loadScene(once, straight, fog(2) + pointLight(place));
    EXPECT_GT(renderSoundly(scene, 256, &met).color.g, 0) << place;
    EXPECT_EQ(met, 256u) << place;
  }
}

/// With a radius r in place of D: ∫ σs T(t) I exp(-σ |t|) / (r² + t²) dt / 4π.
TEST(LightOnTheRay, ARadiusDecides) {
  for (const double radius : {0.1, 1e-3}) {
    std::uint64_t met = 0;
    const TestScene scene = loadScene(
        once, straight,
        fog(2) + pointLight(R"(x="0" y="0" z="0")", fmt::format(R"(<float name="radius" value="{}"/>)", radius)));
    const render::PixelEstimate pixel = renderSoundly(scene, 4096, &met);
    EXPECT_EQ(met, 0u);
    const double r = static_cast<double>(static_cast<float>(radius));
    const double expected = 2 * 2 * 0.9 / (4 * std::numbers::pi) *
                            integrate(
                                [&](double angle) {
                                  const double t = r * std::tan(angle);
                                  return std::exp(-2 * (1 + t + std::fabs(t))) / r;
                                },
                                -std::atan(1 / r), std::atan(1 / r), 2000);
    EXPECT_NEAR(static_cast<double>(pixel.color.g), expected,
                4 * static_cast<double>(pixel.standardError.g) + 1e-3 * expected);
    EXPECT_LT(static_cast<double>(pixel.standardError.g), 0.01 * expected);
  }
}

/// In front of the medium, behind it, at the camera: on the line, and the closed limit 1/a - 1/b holds.
TEST(LightOnTheRay, OutsideOfTheMediumMeetsQuadrature) {
  for (const double z : {-2.0, 3.0, -5.0}) {
    std::uint64_t met = 0;
    const TestScene scene = loadScene(once, straight, fog(2) + pointLight(fmt::format(R"(x="0" y="0" z="{}")", z)));
    const render::PixelEstimate pixel = renderSoundly(scene, 4096, &met);
    EXPECT_EQ(met, 0u);
    const double expected = 2 * 2 * 0.9 / (4 * std::numbers::pi) *
                            integrate(
                                [&](double t) {
                                  const double inFog = z < 0 ? t + 1 : 1 - t;
                                  return std::exp(-2 * (1 + t + inFog)) / ((z - t) * (z - t));
                                },
                                -1, 1, 200);
    EXPECT_NEAR(static_cast<double>(pixel.color.g), expected,
                4 * static_cast<double>(pixel.standardError.g) + 1e-3 * expected)
        << z;
    EXPECT_LT(static_cast<double>(pixel.standardError.g), 0.04 * expected) << z;
  }
}

/// A millionth of a unit beside the ray the integral is finite, and met: π / D and a little more.
TEST(LightBesideTheRay, AMillionthAwayInADenseMedium) {
  const TestScene scene = loadScene(once, straight, fog(20) + pointLight(R"(x="1e-6" y="0" z="-0.9")"));
  std::uint64_t met = 0;
  const render::PixelEstimate pixel = renderSoundly(scene, 4096, &met);
  EXPECT_EQ(met, 0u);
  const double d = static_cast<double>(1e-6f), z = static_cast<double>(-0.9f);
  const double expected = 2 * 20 * 0.9 / (4 * std::numbers::pi) *
                          integrate(
                              [&](double angle) {
                                const double t = d * std::tan(angle);
                                return std::exp(-20 * (1 + z + t + std::sqrt(d * d + t * t))) / d;
                              },
                              std::atan((-1 - z) / d), std::atan((1 - z) / d), 200000);
  EXPECT_NEAR(static_cast<double>(pixel.color.g), expected,
              4 * static_cast<double>(pixel.standardError.g) + 5e-3 * expected);
  EXPECT_LT(static_cast<double>(pixel.standardError.g), 0.01 * expected);
}

/// A cone of a ten-thousandth of a degree: full light inside of it, none outside, on a surface and along a ray of fog.
TEST(NarrowSpot, OfATenThousandthOfADegree) {
  const auto spot = [](double z) {
    return fmt::format(R"(<emitter type="spot"><transform name="to_world"><lookat origin="0,0,{}" target="0,0,9"
        up="0,1,0"/></transform><float name="cutoff_angle" value="1e-4"/><float name="beam_width" value="1e-4"/>
        <rgb name="intensity" value="2"/></emitter>)",
                       z);
  };
  // Pixels of 8.7e-6, in the middle of which is all of a disk of light with that radius.
  const TestSensor sensor{.fov = 5e-4, .width = 5, .height = 5};
  const TestScene wall = loadScene(once, sensor, spot(-5) + R"(<shape type="rectangle"><transform name="to_world">
      <rotate y="1" angle="180"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>)");
  const auto film = wall.render(64);
  EXPECT_EQ(film->droppedCount(), 0u);
  EXPECT_NEAR(film->estimate(2, 2).color.g, 0.5 / std::numbers::pi * 2 / 25, 1e-6);
  EXPECT_EQ(film->estimate(0, 2).color.g, 0);
  EXPECT_EQ(film->estimate(2, 4).color.g, 0);

  const TestScene fogged = loadScene(once, straight, fog(2) + spot(-2));
  const render::PixelEstimate pixel = renderSoundly(fogged, 4096);
  const double expected = 2 * 2 * 0.9 / (4 * std::numbers::pi) *
                          integrate([](double t) { return std::exp(-4 * (1 + t)) / ((2 + t) * (2 + t)); }, -1, 1, 200);
  EXPECT_NEAR(static_cast<double>(pixel.color.g), expected,
              4 * static_cast<double>(pixel.standardError.g) + 1e-3 * expected);
  EXPECT_LT(static_cast<double>(pixel.standardError.g), 0.03 * expected);
}

/// Infinite fog around the camera, the light beside, behind and at it.
TEST(LightInEndlessFog, IsFinite) {
  for (const char* place : {R"(x="0.5" y="0" z="3")", R"(x="0" y="0" z="-9")", R"(x="0" y="0" z="-5")"}) {
    TestSensor sensor = straight;
    sensor.medium =
        R"(<medium type="homogeneous"><rgb name="sigma_t" value="0.2"/><rgb name="albedo" value="0.9"/></medium>)";
    const TestScene scene = loadScene("", sensor, pointLight(place));
    EXPECT_GT(renderSoundly(scene, 256).color.g, 0) << place;
  }
}

}  // namespace
}  // namespace aerosol::test

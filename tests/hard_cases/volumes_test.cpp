#include <fmt/format.h>

#include "core/scene/loader.h"
#include "tests/render/film_checks.h"

// Hard cases of overlapping, touching, many, thin and far volumes as whole renders: finite, and right in the mean.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"/>)";
const TestSensor wide{.fov = 60, .width = 12, .height = 12};

/// An absorbing box across the view from z0 to z1.
std::string layer(double z0, double z1, double sigma) {
  return fmt::format(R"(<volume type="box"><transform name="to_world"><scale x="60" y="60" z="{}"/>
      <translate x="0" y="0" z="{}"/></transform><medium type="homogeneous"><rgb name="sigma_t" value="{}"/>
      <rgb name="albedo" value="0"/></medium></volume>)",
                     0.5 * (z1 - z0), 0.5 * (z0 + z1), sigma);
}

ExpectedRadiance beyondDepth(double depth) {
  return [=](const Ray<World>& ray) {
    return Color(static_cast<float>(std::exp(-depth / static_cast<double>(ray.direction.z))));
  };
}

TEST(CoincidentBoundaries, MediaThatTouchAddUpWithoutGapOrOverlap) {
  const TestScene two = loadScene("", wide, sky + layer(-1, 0.3, 0.3) + layer(0.3, 1, 0.5));
  EXPECT_TRUE(shows(two, *two.render(1024), beyondDepth(1.3 * 0.3 + 0.7 * 0.5)));
  const TestScene three = loadScene("", wide, sky + layer(-1, 0.1, 0.3) + layer(0.1, 1, 0.2) + layer(0.1, 0.6, 0.4));
  EXPECT_TRUE(shows(three, *three.render(1024), beyondDepth(1.1 * 0.3 + 0.9 * 0.2 + 0.5 * 0.4)));
}

TEST(CoincidentBoundaries, OverlapsWithCoplanarFaces) {
  const TestScene front = loadScene("", wide, sky + layer(-1, 1, 0.15) + layer(-1, 0.5, 0.3));
  EXPECT_TRUE(shows(front, *front.render(1024), beyondDepth(2 * 0.15 + 1.5 * 0.3)));
  const TestScene both = loadScene("", wide, sky + layer(-1, 1, 0.1) + layer(-1, 1, 0.25));
  EXPECT_TRUE(shows(both, *both.render(1024), beyondDepth(2 * 0.35)));
}

TEST(CoincidentBoundaries, ACameraInThePlaneOfAFace) {
  // The near face of the box is the plane z = -5 through the camera; the box is in front of it.
  const TestScene scene = loadScene("", wide, sky + layer(-5, -4, 0.6));
  EXPECT_TRUE(shows(scene, *scene.render(1024), [](const Ray<World>& ray) {
    const double length = 1 / static_cast<double>(ray.direction.z) - static_cast<double>(ray.tMin);
    return Color(static_cast<float>(std::exp(-0.6 * length)));
  }));
}

/// Rays at right angles through the middle of a lattice of faces, edges and corners.
TEST(CoincidentBoundaries, AxisParallelViewOfTouchingBoxes) {
  std::string boxes = sky;
  for (int i = 0; i < 4; ++i) {
    boxes += fmt::format(
        R"(<volume type="box"><transform name="to_world"><scale value="10"/><translate x="{}" y="{}" z="10"/>
        </transform><medium type="homogeneous"><rgb name="sigma_t" value="0.05"/><rgb name="albedo" value="0"/></medium></volume>)",
        i % 2 == 0 ? -10 : 10, i / 2 == 0 ? -10 : 10);
  }
  const TestScene scene = loadScene("", {.fov = 0.01, .width = 9, .height = 9}, boxes);
  EXPECT_TRUE(
      shows(scene, *scene.render(4096), [](const Ray<World>&) { return Color(static_cast<float>(std::exp(-1.0))); }));
}

TEST(TangentRays, ASphereSeenAtItsRim) {
  // The left half of the film misses the sphere, the right half grazes it.
  const TestScene scene = loadScene("", {.origin = "1, 0, -5", .target = "1, 0, 0", .fov = 0.02}, std::string(sky) + R"(
      <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="20"/><rgb name="albedo" value="0"/>
      </medium></volume>)");
  const auto film = scene.render(2048);
  EXPECT_TRUE(shows(
      scene, *film,
      [](const Ray<World>& ray) {
        const std::array<double, 2> inside = throughSphere(ray, 1);
        return Color(static_cast<float>(std::exp(-20 * (inside[1] - inside[0]))));
      },
      0.004));
}

TEST(ManyVolumes, AThousandWithIdenticalBounds) {
  std::string content = sky;
  for (int i = 0; i < 1000; ++i) content += layer(-1, 1, 0.0005);
  const TestScene scene = loadScene("", {.fov = 60, .width = 4, .height = 4}, content);
  EXPECT_TRUE(shows(scene, *scene.render(512), beyondDepth(1), 0.02));
}

TEST(ManyVolumes, AThousandNested) {
  std::string content = sky;
  double depth = 0;
  for (int i = 0; i < 1000; ++i) {
    const double half = 1 - 0.0009 * i;
    content += layer(-half, half, 0.001);
    depth += 2 * half * 0.001;
  }
  const TestScene scene = loadScene("", {.fov = 60, .width = 2, .height = 2}, content);
  EXPECT_TRUE(shows(scene, *scene.render(128), beyondDepth(depth), 0.08));
}

TEST(ManyVolumes, TenThousandDisjoint) {
  std::string content = sky;
  for (int i = 0; i < 10000; ++i) content += layer(-1 + 0.0002 * i, -1 + 0.0002 * (i + 1), 0.5);
  const TestScene scene = loadScene("", {.fov = 60, .width = 2, .height = 2}, content);
  EXPECT_TRUE(shows(scene, *scene.render(64), beyondDepth(1), 0.12));
}

/// A hundred scripted volumes with identical bounds: each is asked at every point.
TEST(ManyVolumes, AHundredScriptedInOnePlace) {
  for (const char* distance : {"null", "marching"}) {
    std::string content = sky;
    for (int i = 0; i < 100; ++i) {
      content += fmt::format(R"(<volume type="box"><transform name="to_world"><scale x="60" y="60" z="1"/></transform>
          <medium type="ramp"><string name="distance" value="{}"/><float name="step_size" value="0.1"/>
          <float name="at_zero" value="0.005"/><float name="slope" value="{}"/><float name="most" value="0.01"/></medium></volume>)",
                             distance, 0.00005 * (i - 50));
    }
    const TestScene scene = loadScene("", {.fov = 60, .width = 4, .height = 4}, content);
    EXPECT_TRUE(shows(scene, *scene.render(512), beyondDepth(1), 0.02)) << distance;
  }
}

TEST(StepSizes, FarTooSmallIsBoundedAndReported) {
  const TestScene scene =
      loadScene("", {.fov = 1, .width = 1, .height = 1}, std::string(sky) + R"(<volume type="sphere">
      <medium type="ramp"><string name="distance" value="marching"/><float name="step_size" value="1e-9"/>
      <float name="at_zero" value="0"/><float name="slope" value="1e-6"/></medium></volume>)");
  const auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 2});
  EXPECT_EQ(report.statistics.trackers.stepLimits, 2u);
  EXPECT_LE(report.statistics.trackers.points, 2u * volume::maximumSteps);
  EXPECT_NEAR(film->estimate(0, 0).color.g, 1, 1e-4);
}

/// Errors that name the place, none of them a render that does not end.
TEST(StepSizes, ZeroNegativeAndNaNAreRefused) {
  for (const char* step : {"0", "-1", "nan", "-1e-30"}) {
    Diagnostics warnings;
    const std::string xml = sceneXml("", wide,
                                     fmt::format(R"(<volume type="sphere"><medium type="homogeneous">
        <float name="step_size" value="{}"/></medium></volume>)",
                                                 step));
    const auto loaded = scene::loadString(xml, "test.xml", {}, {}, warnings);
    ASSERT_FALSE(loaded) << step;
    EXPECT_GT(loaded.errors().entries()[0].location.line, 0) << step;
  }
}

TEST(StepSizes, LargerThanTheVolumeIsOneCell) {
  const TestScene scene = loadScene("", wide, std::string(sky) + R"(<volume type="box"><transform name="to_world">
      <scale x="60" y="60" z="1"/></transform><medium type="ramp"><string name="distance" value="marching"/>
      <float name="step_size" value="1e9"/><float name="at_zero" value="0.25"/><float name="slope" value="1e-3"/></medium></volume>)");
  const auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 1024});
  EXPECT_TRUE(shows(scene, *film, beyondDepth(0.5)));
  EXPECT_EQ(report.statistics.trackers.points, 12u * 12 * 1024);
}

/// Light through a medium whose bound is too low by far: single shadow rays are negative, their mean is right.
TEST(SignedTransmittance, KeepsItsMean) {
  const TestScene scene =
      loadScene(R"(<integer name="max_depth" value="2"/>)", {.origin = "0, 1, -3", .target = "0, 0, 0", .fov = 15}, R"(
      <emitter type="directional"><vector name="direction" x="0" y="-1" z="0"/><rgb name="irradiance" value="3.14159265"/></emitter>
      <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="20"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></shape>
      <volume type="box"><transform name="to_world"><scale x="10" y="0.5" z="10"/><translate x="0" y="4" z="0"/></transform>
      <medium type="ramp"><string name="distance" value="null"/><float name="at_zero" value="1"/>
      <float name="slope" value="1e-3"/><float name="most" value="0.45"/></medium></volume>)");
  const auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 1024});
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>&) { return Color(static_cast<float>(std::exp(-1.0))); }, 0.008));
  EXPECT_GT(report.statistics.trackers.boundViolations, 1000u);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const render::PixelEstimate pixel = film->estimate(x, y);
      EXPECT_GT(pixel.color.g, -4 * pixel.standardError.g);
    }
  }
}

/// Scenes in other units: everything a million times smaller or larger, extinction in proportion.
TEST(Scales, MillionthsAndMillions) {
  for (const double scale : {1e-6, 1e6}) {
    const TestScene scene = loadScene(
        "",
        {.origin = fmt::format("0, 0, {}", -5 * scale), .fov = 30, .nearClip = 0.01 * scale, .farClip = 100 * scale},
        fmt::format(R"({}<volume type="sphere"><transform name="to_world"><scale value="{}"/></transform>
        <medium type="homogeneous"><rgb name="sigma_t" value="{}"/><rgb name="albedo" value="0"/></medium></volume>)",
                    sky, scale, 1 / scale));
    EXPECT_TRUE(shows(scene, *scene.render(1024), [&](const Ray<World>& ray) {
      const std::array<double, 2> inside = throughSphere(ray, scale);
      return Color(static_cast<float>(std::exp(-(inside[1] - inside[0]) / scale)));
    })) << scale;
  }
}

}  // namespace
}  // namespace aerosol::test

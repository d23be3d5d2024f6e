#include <fmt/format.h>

#include <numbers>
#include <set>

#include "core/render/clear_sky.h"
#include "tests/render/film_checks.h"

// Each kind of light on a diffuse plane.

namespace aerosol::test {
namespace {

using std::numbers::pi;

/// The plane y = 0, seen from above and aside; the lights are above it and out of sight.
constexpr const char* plane = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
    <scale value="30"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.5, 0.2"/></bsdf></shape>)";
const TestSensor fromAbove{.origin = "0, 2, -2", .target = "0, 0, 0.2", .fov = 40};
constexpr const char* direct = R"(<integer name="max_depth" value="2"/>)";

/// Radiance of the plane where a ray meets it, of the irradiance there.
ExpectedRadiance reflected(std::function<double(double x, double z)> irradiance) {
  return [=](const Ray<World>& ray) {
    const double t = -static_cast<double>(ray.origin.y) / static_cast<double>(ray.direction.y);
    const double x = static_cast<double>(ray.origin.x) + t * static_cast<double>(ray.direction.x);
    const double z = static_cast<double>(ray.origin.z) + t * static_cast<double>(ray.direction.z);
    return Color(0.8f, 0.5f, 0.2f) * static_cast<float>(irradiance(x, z) / pi);
  };
}

TEST(LightsOnAPlane, Point) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(<emitter type="point">
      <point name="position" x="0.3" y="1.5" z="0.2"/><rgb name="intensity" value="4"/></emitter>)");
  EXPECT_TRUE(shows(scene, *scene.render(64), reflected([](double x, double z) {
                      const double squared = (x - 0.3) * (x - 0.3) + 1.5 * 1.5 + (z - 0.2) * (z - 0.2);
                      return 4 * 1.5 / (squared * std::sqrt(squared));
                    })));
}

TEST(LightsOnAPlane, Directional) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(<emitter type="directional">
      <vector name="direction" x="1" y="-2" z="2"/><rgb name="irradiance" value="3"/></emitter>)");
  EXPECT_TRUE(shows(scene, *scene.render(4), reflected([](double, double) { return 2; })));
}

TEST(LightsOnAPlane, Constant) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(<emitter type="constant">
      <rgb name="radiance" value="2"/></emitter>)");
  EXPECT_TRUE(shows(scene, *scene.render(256), reflected([](double, double) { return 2 * pi; }), 0.003));
}

/// A square of half width 1 at y = 1.5 that faces down.
TEST(LightsOnAPlane, Rectangle) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(<shape type="rectangle">
      <transform name="to_world"><rotate x="1" angle="90"/><translate x="0" y="1.5" z="2"/></transform>
      <bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape>)");
  EXPECT_TRUE(shows(scene, *scene.render(1024), reflected([](double x, double z) {
                      return integrate(
                          [&](double a) {
                            return integrate(
                                [&](double b) {
                                  const double squared = (x - a) * (x - a) + 1.5 * 1.5 + (z - 2 - b) * (z - 2 - b);
                                  return 2 * 1.5 * 1.5 / (squared * squared);
                                },
                                -1, 1, 3);
                          },
                          -1, 1, 3);
                    })));
}

/// A ball above the plane's horizon: π L (R / d)² cos.
TEST(LightsOnAPlane, Sphere) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(<shape type="sphere">
      <point name="center" x="0.5" y="2" z="1.5"/><float name="radius" value="0.5"/>
      <bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>)");
  EXPECT_TRUE(shows(scene, *scene.render(1024), reflected([](double x, double z) {
                      const double squared = (x - 0.5) * (x - 0.5) + 4 + (z - 1.5) * (z - 1.5);
                      return pi * 3 * 0.25 / squared * 2 / std::sqrt(squared);
                    })));
}

TEST(LightsOnAPlane, SeveralKindsAddUp) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(
      <emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
      <emitter type="directional"><vector name="direction" x="1" y="-2" z="2"/><rgb name="irradiance" value="1.5"/></emitter>
      <emitter type="point"><point name="position" x="0.3" y="1.5" z="0.2"/><rgb name="intensity" value="1"/></emitter>)");
  EXPECT_TRUE(shows(scene, *scene.render(1024), reflected([](double x, double z) {
                      const double squared = (x - 0.3) * (x - 0.3) + 1.5 * 1.5 + (z - 0.2) * (z - 0.2);
                      return 0.3 * pi + 1 + 1.5 / (squared * std::sqrt(squared));
                    })));
}

/// Straight down from y = 3 above (0.2, 0): full within 20 degrees of the axis, nothing beyond 40.
TEST(LightsOnAPlane, Spot) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(<emitter type="spot">
      <rgb name="intensity" value="5"/><float name="cutoff_angle" value="40"/><float name="beam_width" value="20"/>
      <transform name="to_world"><rotate x="1" angle="90"/><translate x="0.2" y="3"/></transform></emitter>)");
  EXPECT_TRUE(shows(scene, *scene.render(64), reflected([](double x, double z) {
                      const double r = std::hypot(x - 0.2, z), angle = std::atan2(r, 3.0) * 180 / pi;
                      const double fall = std::clamp((40 - angle) / 20, 0.0, 1.0);
                      return 5 * fall * 3 / std::pow(r * r + 9, 1.5);
                    }),
                    0.003));
}

/// Straight down from y = 3 above (0.2, 0), with the picture's top towards +z: on the plane the irradiance is even.
std::string projector(int fov, const std::string& inside) {
  return fmt::format(R"(<emitter type="projector"><float name="fov" value="{}"/>)", fov) +
         R"(<transform name="to_world">
      <lookat origin="0.2, 3, 0" target="0.2, 0, 0" up="0, 0, 1"/></transform>)" +
         inside + "</emitter>";
}

TEST(LightsOnAPlane, ProjectorIsEvenInItsRectangle) {
  const std::string irradiance = R"(<rgb name="irradiance" value="0.5"/><float name="scale" value="6"/>
      <float name="aspect" value="2"/>)";
  const TestScene inside = loadScene(direct, fromAbove, std::string(plane) + projector(140, irradiance));
  EXPECT_TRUE(shows(inside, *inside.render(64), reflected([](double, double) { return pi * 3 / 9; })));
  // With an edge in the picture: the whole light on a plane that is large enough, from right above.
  const TestScene whole = loadScene(direct, {.origin = "0.2, 6, 0.001", .target = "0.2, 0, 0", .fov = 60},
                                    std::string(plane) + projector(60, irradiance));
  ASSERT_TRUE(whole.scene());
  const auto film = whole.render(1024);
  double sum = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) sum += static_cast<double>(film->estimate(x, y).color.r) / 256;
  }
  // The camera sees a square of half side 6 tan 30; the light fills half of that in x and a quarter in z.
  EXPECT_NEAR(sum / (0.8 * 3 / 9 / 8), 1, 0.01);
}

TEST(LightsOnAPlane, ProjectorShowsItsPictureUpright) {
  // The light looks down with +z as its up, so +x is on its left. The image's aspect is the bitmap's.
  const TestScene scene = loadScene(direct, {.origin = "0.2, 3, 0.001", .target = "0.2, 0, 0", .fov = 50},
                                    std::string(plane) + projector(60, fmt::format(R"(
      <texture type="bitmap" name="irradiance"><string name="filename" value="{}/sky.ppm"/>
      <string name="filter_type" value="nearest"/></texture>)",
                                                                                   shaderFolder().string())));
  ASSERT_TRUE(scene.scene());
  constexpr int texels[3][4][3] = {{{200, 200, 250}, {120, 150, 200}, {90, 100, 180}, {130, 140, 190}},
                                   {{100, 220, 100}, {60, 30, 20}, {255, 255, 255}, {80, 90, 100}},
                                   {{30, 40, 30}, {50, 60, 30}, {20, 20, 20}, {90, 50, 10}}};
  const double halfX = 3 * std::tan(pi / 6), halfZ = halfX * 3 / 4;
  // The texel that a place of the film shows, or -1.
  const auto texelAt = [&](int x, int y, double dx, double dy) {
    const Ray<World> ray =
        scene.scene()->camera->ray({.x = static_cast<float>(x + dx), .y = static_cast<float>(y + dy)});
    const double t = -static_cast<double>(ray.origin.y) / static_cast<double>(ray.direction.y);
    const double px = static_cast<double>(ray.origin.x) + t * static_cast<double>(ray.direction.x) - 0.2;
    const double pz = static_cast<double>(ray.origin.z) + t * static_cast<double>(ray.direction.z);
    const double u = 0.5 - 0.5 * px / halfX, v = 0.5 - 0.5 * pz / halfZ;
    return u < 0 || u >= 1 || v < 0 || v >= 1 ? -1 : static_cast<int>(v * 3) * 4 + static_cast<int>(u * 4);
  };
  const auto film = scene.render(16);
  std::set<int> seen;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const int texel = texelAt(x, y, 0, 0);
      const bool isWithin =
          texel == texelAt(x, y, 1, 0) && texel == texelAt(x, y, 0, 1) && texel == texelAt(x, y, 1, 1);
      if (!isWithin) continue;
      seen.insert(texel);
      const Color reflectance(0.8f, 0.5f, 0.2f);
      for (int c = 0; c < 3; ++c) {
        const double light = texel < 0 ? 0 : linearFromByte(texels[texel / 4][texel % 4][c]) / 9;
        EXPECT_NEAR(static_cast<double>(film->estimate(x, y).color[c]), light * static_cast<double>(reflectance[c]),
                    1e-5)
            << x << ' ' << y;
      }
    }
  }
  EXPECT_GE(seen.size(), 12u);
}

/// Its zenith turned to +y; the sun stands towards +x then.
constexpr const char* clearSky = R"(<emitter type="sunsky"><float name="turbidity" value="4"/>
    <rgb name="albedo" value="0.9, 0.1, 0.4"/><vector name="sun_direction" x="0.7660444" y="0.6427876" z="0"/><float name="{}" value="0"/>
    <transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>)";

TEST(LightsOnAPlane, ClearSky) {
  const TestScene scene =
      loadScene(direct, fromAbove, std::string(plane) + fmt::format(fmt::runtime(clearSky), "sun_scale"));
  const render::ClearSky sky(50 * pi / 180, 4, Color(0.9f, 0.1f, 0.4f));
  std::array<double, 3> irradiance{};
  constexpr int n = 300;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 4 * n; ++j) {
      const double c = std::sqrt((i + 0.5) / n), sine = std::sqrt(1 - c * c), phi = 2 * pi * (j + 0.5) / (4 * n);
      const double towardsSun = sine * std::cos(phi) * std::sin(50 * pi / 180) + c * std::cos(50 * pi / 180);
      const Color radiance = sky.sky(c, std::acos(std::min(towardsSun, 1.0)));
      for (std::size_t k = 0; k < 3; ++k)
        irradiance[k] += pi * static_cast<double>(radiance[static_cast<int>(k)]) / (4.0 * n * n);
    }
  }
  EXPECT_TRUE(shows(scene, *scene.render(512), [=](const Ray<World>&) {
    return Color(0.8f, 0.5f, 0.2f) * color([&](int c) { return irradiance[static_cast<std::size_t>(c)] / pi; });
  }));
}

TEST(LightsOnAPlane, TheSunAloneIsParallelLight) {
  const TestScene scene =
      loadScene(direct, fromAbove, std::string(plane) + fmt::format(fmt::runtime(clearSky), "sky_scale"));
  ASSERT_TRUE(scene.scene());
  // As Mitsuba 3 has it, by the model of Hosek and Wilkie.
  const Color sun(20281.355f, 16417.963f, 11824.403f);
  const double irradiance = 2 * pi * (1 - std::cos(0.5358 / 2 * pi / 180)) * std::cos(50 * pi / 180);
  EXPECT_TRUE(shows(scene, *scene.render(256), [=](const Ray<World>&) {
    return Color(0.8f, 0.5f, 0.2f) * sun * static_cast<float>(irradiance / pi);
  }));
}

/// Of a sun on the horizon the upper half is there.
TEST(LightsFromAfar, TheSunSetsBehindTheHorizon) {
  const TestScene scene =
      loadScene(direct, {.origin = "0, 0, 0", .target = "1, 0, 0", .fov = 4, .width = 8, .height = 8},
                R"(<emitter type="sunsky"><vector name="sun_direction" x="1" y="0" z="0"/>
      <float name="sun_aperture" value="20"/><float name="sky_scale" value="0"/>
      <transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const Color color = film->estimate(x, y).color;
      if (y >= 4) EXPECT_EQ(color, Color()) << x << ' ' << y;
      if (y < 4) EXPECT_GT(color.r, 0.01f) << x << ' ' << y;
    }
  }
}

/// sky.ppm in a direction of its own space: +y the upper row, the middle of the image at -z.
std::array<double, 3> skyAt(double x, double y, double z) {
  constexpr int texels[3][4][3] = {{{200, 200, 250}, {120, 150, 200}, {90, 100, 180}, {130, 140, 190}},
                                   {{100, 220, 100}, {60, 30, 20}, {255, 255, 255}, {80, 90, 100}},
                                   {{30, 40, 30}, {50, 60, 30}, {20, 20, 20}, {90, 50, 10}}};
  double u = std::atan2(x, -z) / (2 * pi);
  u -= std::floor(u);
  const double v = std::acos(std::clamp(y, -1.0, 1.0)) / pi;
  const double s = u * 4 - 0.5, t = v * 2;
  const int i = static_cast<int>(std::floor(s)), j = std::min(static_cast<int>(t), 1);
  std::array<double, 3> sum{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto texel = [&](int di, int dj) { return linearFromByte(texels[j + dj][(i + di + 4) % 4][c]); };
    const double a = s - i, b = t - j;
    sum[c] = (1 - b) * ((1 - a) * texel(0, 0) + a * texel(1, 0)) + b * ((1 - a) * texel(0, 1) + a * texel(1, 1));
  }
  return sum;
}

/// An image around the scene, turned by 30 degrees about y and scaled, which changes nothing: the irradiance by
/// quadrature.
TEST(LightsOnAPlane, EnvironmentMap) {
  const TestScene scene = loadScene(direct, fromAbove,
                                    std::string(plane) + fmt::format(R"(<emitter type="envmap">
      <string name="filename" value="{}/sky.ppm"/><float name="scale" value="1.5"/>
      <transform name="to_world"><rotate y="1" angle="30"/><scale value="7"/></transform></emitter>)",
                                                                     shaderFolder().string()));
  std::array<double, 3> irradiance{};
  constexpr int n = 400;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 4 * n; ++j) {
      const double c = std::sqrt((i + 0.5) / n), sine = std::sqrt(1 - c * c), phi = 2 * pi * (j + 0.5) / (4 * n);
      const double x = sine * std::cos(phi), z = sine * std::sin(phi);
      // Back into the image's space: rotated about y by -30 degrees.
      const double cosine = std::cos(pi / 6), turn = std::sin(pi / 6);
      const auto radiance = skyAt(cosine * x - turn * z, c, turn * x + cosine * z);
      for (std::size_t k = 0; k < 3; ++k) irradiance[k] += 1.5 * pi * radiance[k] / (4.0 * n * n);
    }
  }
  EXPECT_TRUE(shows(scene, *scene.render(1024), [=](const Ray<World>&) {
    return Color(0.8f, 0.5f, 0.2f) * color([&](int c) { return irradiance[static_cast<std::size_t>(c)] / pi; });
  }));
}

/// The same image seen by the camera.
TEST(Lights, AnEnvironmentMapIsSeenWhereItIs) {
  const TestScene scene = loadScene("", {.fov = 60},
                                    fmt::format(R"(<emitter type="envmap"><string name="filename" value="{}/sky.ppm"/>
      </emitter>)",
                                                shaderFolder().string()));
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>& ray) {
    const auto d = ray.direction;
    const auto sky = skyAt(static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z));
    return color([&](int c) { return sky[static_cast<std::size_t>(c)]; });
  }));
}

/// A striped square overhead: what arrives from the bright stripes, found by light samples and by directions alike.
TEST(LightsOnAPlane, TexturedRectangle) {
  const TestScene scene = loadScene(direct, fromAbove, std::string(plane) + R"(<shape type="rectangle">
      <transform name="to_world"><rotate x="1" angle="90"/><translate x="0" y="1.5" z="0.2"/></transform>
      <bsdf type="diffuse"/><emitter type="area"><texture type="bars" name="radiance"/></emitter></shape>)");
  const auto irradiance = [](double x, double z) {
    double sum = 0;
    for (int stripe = 0; stripe < 4; stripe += 2) {
      sum += integrate(
          [&](double a) {
            return integrate(
                [&](double b) {
                  const double squared = (x - a) * (x - a) + 1.5 * 1.5 + (z - 0.2 - b) * (z - 0.2 - b);
                  return 1.5 * 1.5 / (squared * squared);
                },
                -1, 1, 3);
          },
          -1 + 0.5 * stripe, -0.5 + 0.5 * stripe, 2);
    }
    return sum;
  };
  EXPECT_TRUE(shows(scene, *scene.render(1536), [&](const Ray<World>& ray) {
    const double t = -static_cast<double>(ray.origin.y) / static_cast<double>(ray.direction.y);
    const double x = static_cast<double>(ray.origin.x) + t * static_cast<double>(ray.direction.x);
    const double z = static_cast<double>(ray.origin.z) + t * static_cast<double>(ray.direction.z);
    return Color(0.8f, 0.25f, 0.05f) * static_cast<float>(irradiance(x, z) / pi);
  }));
}

/// An absorbing slab between light and plane: Beer's law along the shadow rays and along the camera's.
TEST(LightsThroughMedia, DirectionalThroughASlab) {
  const TestScene scene =
      loadScene(direct, {.origin = "0, 4, -2", .target = "0, 0, 0.2", .fov = 30}, std::string(plane) + R"(
      <emitter type="directional"><vector name="direction" x="1" y="-2" z="2"/><rgb name="irradiance" value="3"/></emitter>
      <volume type="box"><transform name="to_world"><scale x="40" y="0.25" z="40"/><translate x="0" y="1" z="0"/></transform>
      <medium type="homogeneous"><rgb name="sigma_t" value="0.8"/><rgb name="albedo" value="0"/></medium></volume>)");
  EXPECT_TRUE(shows(scene, *scene.render(512), [](const Ray<World>& ray) {
    const double seen = std::exp(-0.8 * 0.5 / -static_cast<double>(ray.direction.y));
    const double lit = std::exp(-0.8 * 0.5 * 1.5);
    return Color(0.8f, 0.5f, 0.2f) * static_cast<float>(2 / pi * seen * lit);
  }));
}

/// The same through a scripted slab: ratio tracking and marched shadow rays.
TEST(LightsThroughMedia, DirectionalThroughAScriptedSlab) {
  for (const char* sampling : {R"(<string name="distance" value="null"/>)",
                               R"(<string name="distance" value="marching"/><float name="step_size" value="0.05"/>)"}) {
    // Looking straight down at z near 0, all of the light comes through a density of 1 + 0.5 z.
    const TestScene scene =
        loadScene(direct, {.origin = "0, 4, 0.01", .target = "0, 0, 0", .fov = 30}, std::string(plane) + R"(
        <emitter type="directional"><vector name="direction" x="0" y="-1" z="1"/><rgb name="irradiance" value="3"/></emitter>
        <volume type="box"><transform name="to_world"><scale x="40" y="0.25" z="40"/><translate x="0" y="1" z="0"/></transform>
        <medium type="ramp">)" + sampling + R"(<float name="at_zero" value="1.6"/><float name="slope" value="0.3"/>
        <float name="most" value="5"/></medium></volume>)");
    EXPECT_TRUE(shows(scene, *scene.render(1536), [](const Ray<World>& ray) {
      const auto at = [&](double y) {
        const double t = (y - static_cast<double>(ray.origin.y)) / static_cast<double>(ray.direction.y);
        return static_cast<double>(ray.origin.z) + t * static_cast<double>(ray.direction.z);
      };
      const double zSeen = 0.5 * (at(0.75) + at(1.25)), zLit = at(0) - 1;
      const double seen = std::exp(-(1.6 + 0.3 * zSeen) * 0.5 / -static_cast<double>(ray.direction.y));
      const double lit = std::exp(-(1.6 + 0.3 * zLit) * 0.5 * std::numbers::sqrt2);
      return Color(0.8f, 0.5f, 0.2f) * static_cast<float>(3 / std::numbers::sqrt2 / pi * seen * lit);
    })) << sampling;
  }
}

}  // namespace
}  // namespace aerosol::test

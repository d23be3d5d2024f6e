#include <fmt/format.h>

#include <cmath>

#include "core/render/fresnel.h"
#include "tests/render/film_checks.h"

// Hard cases of numbers: far out, tiny and huge side by side, the edge of total reflection; and of water and liquids.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"/>)";
constexpr const char* manyBounces =
    R"(<integer name="max_depth" value="2000"/><integer name="rr_depth" value="2000"/>)";

/// Reflectance from the law itself, in long double.
long double reflectanceOf(long double cosine, long double eta) {
  const long double sine2 = (1 - cosine * cosine) / (eta * eta);
  if (sine2 >= 1) return 1;
  const long double inside = std::sqrt(1 - sine2);
  const long double s = (cosine - eta * inside) / (cosine + eta * inside);
  const long double p = (eta * cosine - inside) / (eta * cosine + inside);
  return (s * s + p * p) / 2;
}

TEST(CriticalAngle, ReflectanceIsThatOfTheLawOnBothSidesAndAtGrazingIncidence) {
  for (const double eta : {1 / 1.5, 1 / 1.33, 1.0, 1.33, 2.4}) {
    const double critical = eta < 1 ? std::sqrt(1 - eta * eta) : 0.0;
    for (const double cosine : {critical - 1e-7, critical, critical + 1e-7, critical + 1e-4, 1e-7, 1e-4, 0.3, 1.0}) {
      if (!(cosine > 0) || cosine > 1) continue;
      const auto c = static_cast<float>(cosine), e = static_cast<float>(eta);
      const double found = static_cast<double>(render::fresnelDielectric(c, e));
      const auto expected =
          static_cast<double>(reflectanceOf(static_cast<long double>(c), static_cast<long double>(e)));
      // At the critical angle the slope is infinite: the value of a neighbouring cosine is as right.
      const auto below =
          static_cast<double>(reflectanceOf(static_cast<long double>(c) * (1 - 4e-7L), static_cast<long double>(e)));
      const auto above =
          static_cast<double>(reflectanceOf(static_cast<long double>(c) * (1 + 4e-7L), static_cast<long double>(e)));
      EXPECT_TRUE(std::isfinite(found) && found >= 0 && found <= 1) << eta << ' ' << cosine;
      EXPECT_GE(found, std::min({expected, below, above}) - 2e-6) << eta << ' ' << cosine;
      EXPECT_LE(found, std::max({expected, below, above}) + 2e-6) << eta << ' ' << cosine;
    }
  }
}

TEST(CriticalAngle, EqualIndicesAreNotThere) {
  const TestScene scene = loadScene(manyBounces, {.fov = 40}, std::string(sky) + R"(<shape type="sphere">
      <bsdf type="dielectric"><float name="ior" value="1"/></bsdf></shape>)");
  EXPECT_TRUE(shows(scene, *scene.render(64), [](const Ray<World>&) { return Color(1.0f); }));
}

/// A ball of absorbing medium under maps that turn it over, shear it and stretch it: what a ray meets is the unit ball
/// in the ball's own space.
TEST(Transforms, MirrorsShearsAndUnevenScales) {
  const std::array<std::array<double, 9>, 3> maps{
      {{-1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 0.7, 0, 0, 1, 0, 0.3, 0, 1}, {0.3, 0, 0, 0, 1.5, 0, 0, 0, 0.02}}};
  for (const auto& m : maps) {
    const std::string matrix =
        fmt::format("{} {} {} 0 {} {} {} 0 {} {} {} 0 0 0 0 1", m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]);
    const TestScene scene = loadScene("", {.fov = 25},
                                      fmt::format(R"({}<volume type="sphere">
        <transform name="to_world"><matrix value="{}"/></transform><medium type="homogeneous">
        <rgb name="sigma_t" value="0.8"/><rgb name="albedo" value="0"/></medium></volume>)",
                                                  sky, matrix));
    const double det =
        m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
    const auto inverse = [&](std::array<double, 3> v) {
      return std::array<double, 3>{((m[4] * m[8] - m[5] * m[7]) * v[0] + (m[2] * m[7] - m[1] * m[8]) * v[1] +
                                    (m[1] * m[5] - m[2] * m[4]) * v[2]) /
                                       det,
                                   ((m[5] * m[6] - m[3] * m[8]) * v[0] + (m[0] * m[8] - m[2] * m[6]) * v[1] +
                                    (m[2] * m[3] - m[0] * m[5]) * v[2]) /
                                       det,
                                   ((m[3] * m[7] - m[4] * m[6]) * v[0] + (m[1] * m[6] - m[0] * m[7]) * v[1] +
                                    (m[0] * m[4] - m[1] * m[3]) * v[2]) /
                                       det};
    };
    EXPECT_TRUE(shows(
        scene, *scene.render(1024),
        [&](const Ray<World>& ray) {
          const auto o = inverse({static_cast<double>(ray.origin.x), static_cast<double>(ray.origin.y),
                                  static_cast<double>(ray.origin.z)});
          const auto d = inverse({static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                                  static_cast<double>(ray.direction.z)});
          const double a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
          const double c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - 1;
          const double root = std::sqrt(std::max(0.0, b * b - a * c));
          return Color(static_cast<float>(std::exp(-0.8 * 2 * root / a)));
        },
        0.004))
        << matrix;
  }
}

/// At 1e7 a float's last digit is 1: a ball of radius 50 is resolved to that.
TEST(FarFromTheOrigin, ABallAtTenMillions) {
  const TestScene scene =
      loadScene("", {.origin = "10000000, 0, -250", .target = "10000000, 0, 0", .fov = 30},
                std::string(sky) + R"(<volume type="sphere"><transform name="to_world"><scale value="50"/>
      <translate x="10000000" y="0" z="0"/></transform><medium type="homogeneous"><rgb name="sigma_t" value="0.02"/>
      <rgb name="albedo" value="0"/></medium></volume>)");
  EXPECT_TRUE(shows(
      scene, *scene.render(1024),
      [](const Ray<World>& ray) {
        Ray<World> moved = ray;
        moved.origin.x = static_cast<float>(static_cast<double>(ray.origin.x) - 1e7);
        const auto inside = throughSphere(moved, 50);
        return Color(static_cast<float>(std::exp(-0.02 * (inside[1] - inside[0]))));
      },
      0.01));
}

/// A pixel of 1e-20 beside one of 1e20: each keeps its own digits, in the film and in what is written.
TEST(Brightness, TinyBesideHuge) {
  const TestScene scene = loadScene("", {.fov = 10, .width = 2, .height = 2}, R"(
      <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><translate x="-1" y="0" z="0"/></transform>
      <emitter type="area"><rgb name="radiance" value="1e20"/></emitter></shape>
      <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><translate x="1" y="0" z="0"/></transform>
      <emitter type="area"><rgb name="radiance" value="1e-20"/></emitter></shape>)");
  const auto film = scene.render(64);
  for (int y = 0; y < 2; ++y) {
    const double a = static_cast<double>(film->estimate(0, y).color.g),
                 b = static_cast<double>(film->estimate(1, y).color.g);
    EXPECT_NEAR(std::max(a, b) / 1e20, 1, 1e-6);
    EXPECT_NEAR(std::min(a, b) / 1e-20, 1, 1e-6);
  }
}

/// A point light a millionth beside the camera's rays, inside of a dense medium: single samples grow without bound and
/// the true value is infinite in the limit; all is finite and the same again.
TEST(LightInAMedium, AMillionthBesideTheRay) {
  for (const char* distance : {"closed form", "marching", "null"}) {
    const bool isConstant = std::string(distance) == "closed form";
    const std::string medium = isConstant ? R"(<medium type="homogeneous"><rgb name="sigma_t" value="30"/>
        <rgb name="albedo" value="0.9"/></medium>)"
                                          : fmt::format(R"(<medium type="ramp"><string name="distance" value="{}"/>
        <float name="step_size" value="0.02"/><float name="at_zero" value="30"/><float name="slope" value="1"/>
        <float name="most" value="32"/><rgb name="albedo" value="0.9"/></medium>)",
                                                        distance);
    const TestScene scene =
        loadScene(R"(<integer name="max_depth" value="6"/>)", {.fov = 1e-4, .width = 2, .height = 2},
                  R"(<emitter type="point"><point name="position" x="0" y="1e-6" z="-0.95"/>
        <rgb name="intensity" value="1"/></emitter><volume type="box">)" +
                      medium + "</volume>");
    const auto a = scene.render(256), b = scene.render(256);
    EXPECT_EQ(a->droppedCount(), 0u) << distance;
    EXPECT_TRUE(identical(*a, *b)) << distance;
    EXPECT_GT(a->estimate(0, 0).color.g, 0) << distance;
    EXPECT_TRUE(isFinite(a->estimate(1, 1).color)) << distance;
  }
}

/// A box across the view between two depths, with the index of air and a colour over a unit of depth.
std::string layer(double z0, double z1, int priority, double transmission) {
  return fmt::format(R"(<shape type="cube"><transform name="to_world"><scale x="50" y="50" z="{}"/>
      <translate x="0" y="0" z="{}"/></transform><bsdf type="dielectric"><float name="ior" value="1"/>
      <float name="transmission_depth" value="1"/><rgb name="transmission_color" value="{}"/>
      <integer name="priority" value="{}"/></bsdf></shape>)",
                     (z1 - z0) / 2, (z0 + z1) / 2, transmission, priority);
}

/// Absorbing liquid modelled into its absorbing glass, and short of it: where both are, the glass is; a gap is empty.
TEST(LiquidInGlass, IntoAndShortOfTheGlass) {
  const double glass = 0.9, liquid = 0.7;
  for (const double start : {-0.7, -0.5 + 1e-4, -0.3}) {
    const TestScene scene =
        loadScene(manyBounces, {.fov = 20}, std::string(sky) + layer(-1, -0.5, 2, glass) + layer(start, 1, 1, liquid));
    const double wet = 1 - std::max(start, -0.5);
    const double depth = -0.5 * std::log(glass) - wet * std::log(liquid);
    EXPECT_TRUE(shows(scene, *scene.render(512), [&](const Ray<World>& ray) {
      return Color(static_cast<float>(std::exp(-depth / static_cast<double>(ray.direction.z))));
    })) << start;
  }
}

/// Water that is an open plane, the camera below it and above it: what lies between the camera and the sky absorbs; the
/// vertical probe finds where the camera is.
TEST(OpenWater, TheCameraBelowAndAbove) {
  for (const double height : {-1.0, -1e-3, 1e-3, 1.0}) {
    const std::string water =
        fmt::format(R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
        <scale value="1000"/></transform><bsdf type="dielectric"><float name="ior" value="1"/>
        <float name="transmission_depth" value="{}"/><rgb name="transmission_color" value="0.5"/></bsdf></shape>)",
                    std::fabs(height));
    const TestScene scene = loadScene(manyBounces,
                                      {.origin = fmt::format("0, {}, 0", height),
                                       .target = fmt::format("0.2, {}, 1", height + 1),
                                       .fov = 20,
                                       .nearClip = 1e-5},
                                      std::string(sky) + water);
    EXPECT_TRUE(shows(scene, *scene.render(1024), [&](const Ray<World>& ray) {
      return Color(static_cast<float>(height < 0 ? std::pow(0.5, 1 / static_cast<double>(ray.direction.y)) : 1.0));
    })) << height;
  }
}

/// The camera inside of two media that overlap: a ball, and water with an open surface.
TEST(OpenWater, TheCameraInsideOfABallUnderWater) {
  const std::string water = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="1000"/></transform><bsdf type="dielectric"><float name="ior" value="1"/><integer name="priority" value="1"/>
      <float name="transmission_depth" value="1"/><rgb name="transmission_color" value="0.5"/></bsdf></shape>)";
  const std::string ball = R"(<shape type="sphere"><point name="center" x="0" y="-2" z="0"/>
      <bsdf type="dielectric"><float name="ior" value="1"/><integer name="priority" value="2"/>
      <float name="transmission_depth" value="1"/><rgb name="transmission_color" value="0.8"/></bsdf></shape>)";
  const TestScene scene = loadScene(manyBounces, {.origin = "0, -2, 0", .target = "0.2, -1, 0.1", .fov = 20},
                                    std::string(sky) + water + ball);
  ASSERT_TRUE(scene.scene());
  EXPECT_EQ(scene.scene()->initialMedia.size(), 2u);
  EXPECT_TRUE(shows(scene, *scene.render(1024), [](const Ray<World>& ray) {
    const double all = 2 / static_cast<double>(ray.direction.y);
    return Color(static_cast<float>(0.8 * std::pow(0.5, all - 1)));
  }));
}

}  // namespace
}  // namespace aerosol::test

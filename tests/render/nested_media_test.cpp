#include <fmt/format.h>

#include "tests/render/film_checks.h"

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

INSTANTIATE_TEST_SUITE_P(Priorities, Overlaps, ::testing::Values(std::pair(2, 1), std::pair(1, 2), std::pair(1, 1)));

}  // namespace
}  // namespace aerosol::test

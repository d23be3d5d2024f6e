#include <cmath>
#include <numbers>

#include "tests/render/film_checks.h"

namespace aerosol::test {
namespace {

/// Of the area of a disk of radius 1: the part where x < t.
double partOfDisk(double t) {
  const double x = std::clamp(t, -1.0, 1.0);
  return 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / std::numbers::pi;
}

/// A bright half-plane twice as far away as the camera's focus. Through a place at x on the lens a point at x₀ of the
/// plane is seen at x₀ - x, so a pixel is as bright as the part of the lens that sees beyond the edge.
TEST(DepthOfField, BlursAnEdgeByTheShareOfTheLensThatSeesIt) {
  constexpr double radius = 0.3;
  const std::string half = R"(<shape type="rectangle"><transform name="to_world"><scale value="50"/>
      <rotate y="1" angle="180"/><translate x="50"/></transform><emitter type="area">
      <rgb name="radiance" value="1, 2, 3"/></emitter></shape>)";
  TestSensor sensor{.fov = 20, .width = 32, .height = 4, .type = "thinlens"};
  sensor.medium = R"(<float name="aperture_radius" value="0.3"/><float name="focus_distance" value="2.5"/>)";
  const TestScene scene = loadScene("", sensor, half);
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, *scene.render(2048), [&](const Ray<World>& ray) {
    // Where the ray goes through the plane of focus tells what the middle of the lens sees.
    const double t = (-2.5 - static_cast<double>(ray.origin.z)) / static_cast<double>(ray.direction.z);
    const double focus = static_cast<double>(ray.origin.x) + t * static_cast<double>(ray.direction.x);
    return Color(1, 2, 3) * static_cast<float>(partOfDisk(2 * focus / radius));
  }));
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include "tests/render/film_checks.h"

// A light that lies exactly on a face of a body with a scattering inside. What the scene names first is in front, seen
// from either side; and what is found by sampling lights agrees with what paths run into.

namespace aerosol::test {
namespace {

constexpr const char* milk = R"(<shape type="cube"><bsdf type="dielectric"><float name="ior" value="1.33"/>
    <float name="transmission_depth" value="1"/><rgb name="transmission_color" value="0.4"/>
    <rgb name="albedo" value="0.9, 0.8, 0.7"/><integer name="priority" value="1"/></bsdf></shape>)";

std::string lamp(double height, int facing) {
  return fmt::format(R"(<shape type="rectangle"><transform name="to_world"><scale value="0.7"/>
      <rotate x="1" angle="{}"/><translate y="{}"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
      <emitter type="area"><rgb name="radiance" value="3, 4, 5"/></emitter></shape>)",
                     90 * facing, height);
}

TestScene load(const std::string& content, int seed) {
  return loadScene(R"(<integer name="max_depth" value="8"/>)",
                   {.origin = "2, 2.5, -6", .fov = 30, .width = 12, .height = 12, .seed = seed},
                   R"(<emitter type="constant"><rgb name="radiance" value="0.1"/></emitter>)" + content);
}

/// Named first, it is as if it was a little inside, where it is seen from.
TEST(LightsOnFaces, NamedFirstAreInFront) {
  const auto inside = load(milk + lamp(0.9995, 1), 0).render(2048);
  EXPECT_TRUE(showTheSame(*inside, *load(lamp(1, 1) + milk, 1).render(2048), 0.01));
}

/// Named last, as if it was a little outside: all its light comes through the face.
TEST(LightsOnFaces, NamedLastAreBehind) {
  const auto outside = load(milk + lamp(1.0005, 1), 0).render(2048);
  EXPECT_TRUE(showTheSame(*outside, *load(milk + lamp(1, 1), 1).render(2048), 0.02));
}

}  // namespace
}  // namespace aerosol::test

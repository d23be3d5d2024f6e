#include <fmt/format.h>

#include <fstream>

#include "tests/render/film_checks.h"

// Fibres as shapes of different kinds.

namespace aerosol::test {
namespace {

std::string fileOf(const std::string& name, const std::string& points) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path) << points;
  return path.string();
}

TestScene fibreOf(const std::string& shape, int seed) {
  return loadScene(R"(<integer name="max_depth" value="6"/><boolean name="transparent_shadows" value="true"/>)",
                   {.origin = "0, 0.3, 4", .fov = 16, .width = 24, .height = 12, .seed = seed},
                   R"(<emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
      <emitter type="directional"><vector name="direction" value="0.5, -0.6, -0.7"/>
        <rgb name="irradiance" value="2"/></emitter>)" +
                       shape + R"(<bsdf type="hair"><float name="eumelanin" value="0.3"/>
        <float name="scale_tilt" value="6"/></bsdf></shape>)");
}

/// The material tells of the whole way through a fibre, so that it does not matter whether there is something behind
/// the first face, and which way a shape's coordinates run.
TEST(Fibres, LookAlikeByCurvesAndByTubes) {
  const std::string curve = R"(<shape type="{}"><string name="filename" value="{}"/>)";
  const TestScene spline =
      fibreOf(fmt::format(fmt::runtime(curve), "bsplinecurve",
                          fileOf("spline.txt", "0 -1.5 0 0.5\n0 -0.5 0 0.5\n0 0.5 0 0.5\n0 1.5 0 0.5\n")),
              1);
  const TestScene line =
      fibreOf(fmt::format(fmt::runtime(curve), "linearcurve", fileOf("line.txt", "0 -1.5 0 0.5\n0 1.5 0 0.5\n")), 2);
  const TestScene tube = fibreOf(R"(<shape type="cylinder"><point name="p0" value="0, -1.5, 0"/>
      <point name="p1" value="0, 1.5, 0"/><float name="radius" value="0.5"/>)",
                                 3);
  ASSERT_TRUE(spline.scene() && line.scene() && tube.scene());
  // All ends lie outside of the view.
  const auto film = line.render(512);
  EXPECT_TRUE(showTheSame(*tube.render(512), *film, 0.005));
  EXPECT_TRUE(showTheSame(*spline.render(512), *film, 0.005));
}

}  // namespace
}  // namespace aerosol::test

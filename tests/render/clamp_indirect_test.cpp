// Light that a scene wants to be limited after its first scattering: off by default, and seen where it is on.

#include "tests/render/film_checks.h"

namespace aerosol::test {
namespace {

constexpr const char* corner = R"(
  <emitter type="point"><point name="position" x="0" y="1.5" z="-1"/><rgb name="intensity" value="6, 5, 4"/></emitter>
  <shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/><translate y="-1"/>
    </transform><bsdf type="diffuse"/></shape>
  <shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate y="1" angle="180"/><translate z="1"/>
    </transform><bsdf type="diffuse"/></shape>
  <shape type="sphere"><point name="center" x="0.6" y="-0.4" z="0"/><float name="radius" value="0.5"/>
    <bsdf type="dielectric"/></shape>
  <volume type="sphere"><transform name="to_world"><translate x="-0.8"/></transform>
    <medium type="homogeneous"><rgb name="sigma_t" value="0.4"/><rgb name="albedo" value="0.8"/></medium></volume>)";

std::vector<float> picture(const std::string& integrator, std::uint64_t* dimmed = nullptr) {
  const TestScene scene = loadScene(integrator, {.fov = 50, .width = 24, .height = 24}, corner);
  EXPECT_TRUE(scene.scene());
  const auto film = scene.film();
  const auto report = scene.renderInto(*film, {.threads = 1, .endSample = 16});
  if (dimmed) *dimmed = report.statistics.work.of(render::Work::clamping);
  return film->rgba();
}

TEST(ClampIndirect, DimsWhatComesAfterTheFirstScattering) {
  std::uint64_t dimmed = 0;
  const std::vector<float> plain = picture(""), direct = picture(R"(<integer name="max_depth" value="2"/>)");
  EXPECT_EQ(picture(R"(<float name="clamp_indirect" value="1e6"/>)", &dimmed), plain);
  EXPECT_EQ(dimmed, 0u);
  // All of the indirect light is gone, none of the rest.
  const std::vector<float> dark = picture(R"(<float name="clamp_indirect" value="1e-9"/>)", &dimmed);
  EXPECT_GT(dimmed, 1000u);
  double indirect = 0;
  for (std::size_t i = 0; i < dark.size(); ++i) {
    ASSERT_NEAR(dark[i], direct[i], 1e-5f * (1 + direct[i])) << i;
    indirect += static_cast<double>(plain[i] - direct[i]);
  }
  EXPECT_GT(indirect / static_cast<double>(dark.size()), 0.01);
  // Between them, with brightness.
  const std::vector<float> some = picture(R"(<float name="clamp_indirect" value="0.1"/>)");
  double kept = 0;
  for (std::size_t i = 0; i < some.size(); ++i) kept += static_cast<double>(some[i] - direct[i]);
  EXPECT_GT(kept, 0.02 * indirect);
  EXPECT_LT(kept, 0.98 * indirect);
}

}  // namespace
}  // namespace aerosol::test

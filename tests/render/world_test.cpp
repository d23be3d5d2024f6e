// Scenes of OSL's testrender, and backgrounds by shaders: against the radiance that their shaders say.

#include "tests/render/film_checks.h"

namespace aerosol::test {
namespace {

constexpr const char* gradient = R"(surface gradient()
      { vector d = normalize(I); Ci = color(1 + 0.5 * d[0], 1 + 0.5 * d[1], 1 + 0.5 * d[2]) * background(); })";

Color gradientAt(Vector<World> d) { return {1 + 0.5f * d.x, 1 + 0.5f * d.y, 1 + 0.5f * d.z}; }

TEST(Background, ShowsWhatItsShaderSays) {
  const TestScene scene = loadScene(
      "", {.fov = 80},
      std::string(R"(<emitter type="background"><bsdf type="osl"><source>)") + gradient + "</source></bsdf></emitter>");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(1);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const Color expected = gradientAt(
          scene.scene()->camera->ray({.x = static_cast<float>(x) + 0.5f, .y = static_cast<float>(y) + 0.5f}).direction);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(film->estimate(x, y).color[c], expected[c], 0.06f);
    }
  }
}

/// A matte wall that faces +z sees the mean of 1 + d/2 by the cosine: 1 + (0, 0, 1/3).
TEST(Background, LightsMatteSurfaces) {
  const TestScene scene = loadScene("", {.origin = "0, 0, 5", .fov = 10},
                                    std::string(R"(<emitter type="background"><bsdf type="osl"><source>)") + gradient +
                                        R"(</source></bsdf></emitter><shape type="rectangle">
      <transform name="to_world"><scale value="9"/></transform></shape>)");
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, *scene.render(512), [](const Ray<World>&) { return Color(0.5f, 0.5f, 0.5f * 4 / 3); }));
}

/// A quad seen from behind: its shader finds the normal towards the viewer, and knows that it is the back.
TEST(World, SurfacesAreSeenFromBothSides) {
  for (const char* dir : {"0, 0, -1", "0, 0, 1"}) {
    const bool isFront = dir[6] == '-';
    const std::string eye = isFront ? "0, 0, 5" : "0, 0, -5";
    const TestScene scene(R"(<World><Camera eye=")" + eye + R"(" dir=")" + dir + R"(" fov="10"/>
      <Option aa="int 8"/>
      <ShaderGroup>shader even_sky sky;</ShaderGroup><Background/>
      <ShaderGroup>param float front 0.75; param float back 0.25; shader both_sides matte;</ShaderGroup>
      <Quad corner="-9,-9,0" edge_x="18,0,0" edge_y="0,18,0"/></World>)",
                          {.shaderFolder = shaderFolder()});
    ASSERT_TRUE(scene.scene());
    render::Film film({320, 240, 322, 242});
    scene.renderInto(film, {.threads = 1, .endSample = 256});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(film.estimate(321, 241).color[c], isFront ? 0.75f : 0.25f, 0.02f) << dir;
  }
}

}  // namespace
}  // namespace aerosol::test

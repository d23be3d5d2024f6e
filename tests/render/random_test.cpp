#include "tests/render/film_checks.h"

// random() in shaders: even numbers, those of the sample, whatever else is rendered.

namespace aerosol::test {
namespace {

constexpr const char* wall = R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/>
    <scale value="9"/></transform><bsdf type="sparkling"/></shape>)";

TEST(Random, IsEvenAndIndependentFromPixelToPixel) {
  const TestScene scene = loadScene("", {}, wall);
  EXPECT_TRUE(shows(scene, *scene.render(1024), [](const Ray<World>&) { return Color(0.5f); }));
}

TEST(Random, IsTheSampleOfThePixel) {
  const TestScene scene = loadScene("", {}, wall);
  ASSERT_TRUE(scene.scene());
  const auto whole = scene.film(), again = scene.film(), crop = scene.film(render::PixelRect{4, 3, 9, 12});
  scene.renderInto(*whole, {.threads = 2, .endSample = 4});
  scene.renderInto(*again, {.threads = 1, .endSample = 4, .pathsInFlight = 7, .batchSize = 3});
  EXPECT_TRUE(identical(*whole, *again));
  scene.renderInto(*crop, {.threads = 1, .endSample = 4});
  for (int y = 3; y < 12; ++y)
    for (int x = 4; x < 9; ++x) EXPECT_EQ(whole->estimate(x, y).color, crop->estimate(x, y).color);
  const auto other = scene.film();
  scene.renderInto(*other, {.threads = 1, .endSample = 4, .seed = 12345});
  EXPECT_FALSE(identical(*whole, *other));
}

}  // namespace
}  // namespace aerosol::test

#include "tests/render/film_checks.h"

// What shaders ask the renderer about the camera, the objects and the ray.

namespace aerosol::test {
namespace {

const TestSensor one{.width = 1, .height = 1};

TEST(Attributes, AnswerWhatTheSceneSays) {
  const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", one, R"(
      <shape type="sphere" id="ball"><float name="radius" value="2"/><rgb name="user:tint" value="0.25, 0.5, 0.75"/>
        <bsdf type="asks"/></shape>
      <shape type="disk" id="other"><transform name="to_world"><translate x="50" y="0" z="0"/></transform>
        <float name="user:size" value="3"/></shape>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(1);
  const auto messages = scene.scene()->messages->sorted();
  ASSERT_EQ(messages.size(), 1u);
  // The ball's area is 4π 2²; its shader's object space is the ball's, so the point seen lies at its radius.
  EXPECT_EQ(messages[0].text, "4 1 1 0.25 0.5 0.75 ball 3 3 back 0 area 50.2655 at 2.000");
}

TEST(Attributes, TellTheBackOfASurface) {
  const TestScene scene = loadScene(R"(<integer name="max_depth" value="1"/>)", one, R"(
      <shape type="rectangle"><transform name="to_world"><scale value="4"/></transform><bsdf type="asks"/></shape>
      <shape type="rectangle"><transform name="to_world"><scale value="4"/><translate x="0" y="0" z="1"/></transform>
        <bsdf type="asks"/></shape>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(1);
  const auto messages = scene.scene()->messages->sorted();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].text.find("2 1 1 0 0 0  -1 -1 back 1 area 64"), std::string::npos) << messages[0].text;
}

}  // namespace
}  // namespace aerosol::test

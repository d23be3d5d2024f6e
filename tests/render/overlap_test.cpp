#include <fmt/format.h>

#include "tests/render/film_checks.h"

// The two designs for overlapping volume primitives as whole renders.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"/>)";

std::string integrator(const char* design) {
  return fmt::format(R"(<integer name="max_depth" value="6"/><string name="overlap" value="{}"/>)", design);
}

/// Overlapping boxes and balls, constant and scripted, some of them scattering; and a wall behind.
std::string crowd(int count) {
  std::string content =
      std::string(sky) + R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/>
      <scale value="9"/><translate z="3"/></transform></shape>)";
  for (int i = 0; i < count; ++i) {
    const double x = std::sin(1.7 * i), y = std::cos(2.3 * i), z = std::sin(0.9 * i + 1);
    const std::string medium =
        i % 3 == 0
            ? R"(<medium type="ramp"><float name="at_zero" value="0.1"/><float name="slope" value="0.05"/>
                        <float name="most" value="0.4"/><rgb name="albedo" value="0.8"/></medium>)"
            : R"(<medium type="homogeneous"><rgb name="sigma_t" value="0.15"/><rgb name="albedo" value="0.7"/></medium>)";
    content += fmt::format(R"(<volume type="{}"><transform name="to_world"><scale value="0.7"/>
        <translate x="{}" y="{}" z="{}"/></transform>{}</volume>)",
                           i % 2 == 0 ? "box" : "sphere", x, y, z, medium);
  }
  return content;
}

TEST(OverlapDesigns, GiveTheSameImageBitByBit) {
  const TestSensor sensor{.fov = 30, .width = 12, .height = 12};
  const TestScene split = loadScene(integrator("split"), sensor, crowd(40));
  const TestScene partition = loadScene(integrator("partition"), sensor, crowd(40));
  ASSERT_TRUE(split.scene() && partition.scene());
  EXPECT_EQ(partition.scene()->geometry->overlapDesign(), accel::OverlapDesign::partition);
  EXPECT_TRUE(identical(*split.render(8), *partition.render(8)));
}

TEST(OverlapDesigns, AreChosenByTheOverlap) {
  const TestSensor sensor{.width = 2, .height = 2};
  const TestScene few = loadScene("", sensor, crowd(2)), many = loadScene("", sensor, crowd(150));
  ASSERT_TRUE(few.scene() && many.scene());
  EXPECT_EQ(few.scene()->geometry->overlapDesign(), accel::OverlapDesign::split);
  EXPECT_EQ(many.scene()->geometry->overlapDesign(), accel::OverlapDesign::partition);
}

/// What moves is where it is at each path's time, whatever is empty at another one.
TEST(OverlapDesigns, LeaveOutNothingThatMoves) {
  std::string content = sky;
  for (int i = 0; i < 6; ++i) {
    content += fmt::format(R"(<volume type="box"><animation name="to_world">
        <transform time="0"><scale value="0.5"/><translate x="-0.8" y="{0}"/></transform>
        <transform time="1"><scale value="0.5"/><translate x="{1}" y="{0}"/></transform></animation>
        <medium type="puff"><float name="density" value="0.8"/></medium></volume>)",
                           0.15 * i - 0.4, i % 2 == 0 ? 0.8 : -0.8);
  }
  content = R"(<sensor type="perspective"><float name="shutter_close" value="1"/><transform name="to_world">
      <lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform><float name="fov" value="30"/>
      <film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="12"/><rfilter type="box"/></film>
      <sampler type="independent"/></sensor>)" +
            content;
  const auto load = [&](const char* design) {
    const std::string integrator =
        fmt::format(R"(<integrator type="path"><string name="overlap" value="{}"/></integrator>)", design);
    return TestScene(R"(<scene version="3.0.0">)" + integrator + content + "</scene>",
                     {.shaderFolder = shaderFolder()});
  };
  const TestScene split = load("split"), partition = load("partition");
  ASSERT_TRUE(split.scene() && partition.scene());
  EXPECT_TRUE(identical(*split.render(16), *partition.render(16)));
}

/// Scripted balls in boxes: bounds prove the corners empty, and a partition leaves them out.
TEST(OverlapDesigns, EmptyPartsAreLeftOut) {
  std::string content = sky;
  for (int i = 0; i < 8; ++i) {
    content += fmt::format(R"(<volume type="box"><transform name="to_world"><scale value="{}"/></transform>
        <medium type="puff"><float name="density" value="0.1"/></medium></volume>)",
                           1 + 0.1 * i);
  }
  const TestSensor sensor{.fov = 30, .width = 12, .height = 12};
  const TestScene scene = loadScene(integrator("partition"), sensor, content);
  ASSERT_TRUE(scene.scene());
  EXPECT_GT(scene.scene()->geometry->partitionStatistics().regions, 0u);
  EXPECT_TRUE(shows(
      scene, *scene.render(1024),
      [](const Ray<World>& ray) {
        double depth = 0;
        for (int i = 0; i < 8; ++i) {
          const auto inside = throughSphere(ray, 1 + 0.1 * i);
          depth += 0.1 * (inside[1] - inside[0]);
        }
        return Color(static_cast<float>(std::exp(-depth)));
      },
      0.005));
}

}  // namespace
}  // namespace aerosol::test

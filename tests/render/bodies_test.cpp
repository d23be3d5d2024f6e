// Bodies whose material says what is inside and sets no priority: where no two of them may meet paths keep no stack of
// media, and the picture is the one that a stack gives, bit by bit.
#include <fmt/format.h>

#include <fstream>

#include "tests/render/film_checks.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::test {
namespace {

constexpr const char* surroundings = R"(<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>
    <emitter type="point"><point name="position" x="1" y="3" z="-4"/></emitter>)";

/// Milk of an index, as parameters of a dielectric.
std::string milk(double ior, const std::string& more = "") {
  return fmt::format(R"(<bsdf type="dielectric"><float name="ior" value="{}"/>
      <float name="transmission_depth" value="1"/><rgb name="transmission_color" value="0.5, 0.7, 0.9"/>
      <rgb name="albedo" value="0.6"/><float name="anisotropy" value="0.3"/>{}</bsdf>)",
                     ior, more);
}

std::string ball(double x, double radius, const std::string& material, const std::string& more = "") {
  return fmt::format(
      R"(<shape type="sphere"><point name="center" x="{}"/><float name="radius" value="{}"/>{}{}</shape>)", x, radius,
      material, more);
}

/// Something with a priority that no path finds: it makes all of them keep a stack.
const std::string farAway = R"(<shape type="sphere"><point name="center" x="3e5" y="2e5" z="-4e5"/>
    <float name="radius" value="1e-3"/><bsdf type="dielectric"><integer name="priority" value="1"/></bsdf></shape>)";

struct Rendered {
  std::unique_ptr<render::Film> film;
  std::uint64_t judged = 0;  ///< Faces, by what is inside of them.
};

Rendered renderCounted(const TestScene& scene) {
  Rendered result{scene.film()};
  result.judged =
      scene.renderInto(*result.film, {.threads = 1, .endSample = 16}).statistics.work.of(render::Work::nesting);
  return result;
}

constexpr const char* bounces = R"(<integer name="max_depth" value="24"/><string name="roulette" value="throughput"/>)";
const TestSensor view{.fov = 50, .width = 24, .height = 16};

/// Renders with and without the stack.
void expectSameWithoutStack(const std::string& content) {
  const TestScene apart = loadScene(bounces, view, surroundings + content);
  const TestScene stacked = loadScene(bounces, view, surroundings + content + farAway);
  ASSERT_TRUE(apart.scene() && stacked.scene());
  EXPECT_FALSE(apart.scene()->nestsMedia);
  EXPECT_TRUE(stacked.scene()->nestsMedia);
  const Rendered direct = renderCounted(apart), counted = renderCounted(stacked);
  EXPECT_EQ(direct.judged, 0u);
  EXPECT_GT(counted.judged, 1000u);
  EXPECT_TRUE(identical(*direct.film, *counted.film));
}

TEST(BodiesWithoutPriority, ApartGiveTheSameBitsWithoutAStack) {
  expectSameWithoutStack(ball(-1.2, 0.5, milk(1.5)) + ball(0, 0.5, milk(1.33)) + ball(1.2, 0.5, milk(1)));
  expectSameWithoutStack(ball(-1, 0.6, R"(<bsdf type="dielectric"><float name="ior" value="1.5"/></bsdf>)") +
                         ball(1, 0.6, milk(1.4, R"(<float name="roughness" value="0.4"/>)")));
}

/// Also where shadow rays pass, in a medium, around other surfaces, under a mirrored transform, with a medium of the
/// scene inside.
TEST(BodiesWithoutPriority, GiveTheSameBitsInAnySurroundings) {
  expectSameWithoutStack(ball(-1, 0.6, milk(1.5, R"(<integer name="straight_shadows" value="1"/>)")) +
                         ball(1, 0.6, milk(1.2), R"(<medium name="interior" type="homogeneous">
                             <rgb name="sigma_t" value="1, 2, 3"/><rgb name="albedo" value="0.8"/></medium>)"));
  expectSameWithoutStack(ball(-1, 0.6, milk(1.5)) + ball(-1, 0.3, R"(<bsdf type="diffuse"/>)") +
                         ball(1, 0.6, milk(1.3), R"(<medium name="exterior" type="homogeneous">
                             <rgb name="sigma_t" value="0.1"/><rgb name="albedo" value="0.5"/></medium>)"));
  expectSameWithoutStack(R"(<shape type="cube"><transform name="to_world"><scale x="-0.6" y="0.5" z="0.7"/>
      <rotate x="1" y="1" angle="30"/></transform>)" +
                         milk(1.5) + R"(</shape><volume type="sphere"><float name="radius" value="3"/>
      <medium type="homogeneous"><rgb name="sigma_t" value="0.2"/><rgb name="albedo" value="0.5"/></medium></volume>)");
}

/// A block stands on a table: its lower face is met together with the table, which is seen through it.
TEST(BodiesWithoutPriority, OnATableItIsSeenThroughThem) {
  for (const bool tableFirst : {false, true}) {
    const std::string table =
        R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/>
        <translate y="-0.5"/></transform><bsdf type="diffuse"/></shape>)";
    const std::string block =
        R"(<shape type="cube"><transform name="to_world"><scale value="0.5"/></transform>)" + milk(1.5) + "</shape>";
    expectSameWithoutStack(tableFirst ? table + block : block + table);
  }
}

/// A box within another, as the beginning of a shape; of a hollow one the inner faces look into it.
std::string boxes(const ScratchFolder& folder, bool isHollow) {
  const std::string file = (folder.path() / "boxes.obj").string();
  std::ofstream obj(file);
  for (const double half : {0.5, 0.3}) {
    for (int i = 0; i < 8; ++i)
      obj << "v " << (i & 1 ? half : -half) << ' ' << (i & 2 ? half : -half) << ' ' << (i & 4 ? half : -half) << '\n';
  }
  constexpr int faces[6][4] = {{1, 5, 7, 3}, {2, 4, 8, 6}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 3, 4, 2}, {5, 6, 8, 7}};
  for (const int first : {0, 8}) {
    for (const auto& f : faces) {
      obj << 'f';
      for (int k = 0; k < 4; ++k) obj << ' ' << f[isHollow && first > 0 ? 3 - k : k] + first;
      obj << '\n';
    }
  }
  return fmt::format(R"(<shape type="obj"><string name="filename" value="{}"/>)", file);
}

/// Paths enter and leave it several times.
TEST(BodiesWithoutPriority, HollowOnesGiveTheSameBitsWithoutAStack) {
  const ScratchFolder folder;
  const std::string turned = R"(<transform name="to_world"><rotate x="1" y="1" angle="35"/></transform>)";
  expectSameWithoutStack(boxes(folder, true) + turned + milk(1.5) + "</shape>");
}

/// What may be around a point together, or around the camera, or be entered more than once, is counted.
TEST(BodiesWithoutPriority, KeepAStackWhereOneIsNeeded) {
  const ScratchFolder folder;
  const std::string shells = boxes(folder, false);
  const std::string moving = R"(<animation name="to_world"><transform time="0"><translate x="0"/></transform>
      <transform time="1"><translate x="1"/></transform></animation>)";
  const struct {
    const char* name;
    std::string content;
  } cases[] = {
      {"overlapping", ball(-0.4, 0.5, milk(1.5)) + ball(0.4, 0.5, milk(1.3))},
      {"touching boxes", ball(-0.5, 0.5, milk(1.5)) + ball(0.5, 0.5, milk(1.3))},
      {"around the camera", ball(0, 6, milk(1.5))},
      {"a priority", ball(0, 0.5, milk(1.5, R"(<integer name="priority" value="-1"/>)"))},
      {"an open surface", R"(<shape type="rectangle">)" + milk(1.5) + "</shape>"},
      {"an open tube", R"(<shape type="cylinder">)" + milk(1.5) + "</shape>"},
      {"turned inside out", ball(0, 0.5, milk(1.5), R"(<boolean name="flip_normals" value="true"/>)")},
      {"moving", ball(0, 0.5, milk(1.5), moving)},
      {"shells within shells", shells + milk(1.5) + "</shape>"},
      {"an inside that varies", ball(0, 0.5, R"(<bsdf type="uneven_glass"/>)")},
  };
  for (const auto& each : cases) {
    TestSensor sensor = view;
    if (std::string(each.name) == "moving") sensor.medium = R"(<float name="shutter_close" value="1"/>)";
    const TestScene scene = loadScene(bounces, sensor, surroundings + each.content);
    ASSERT_TRUE(scene.scene()) << each.name;
    EXPECT_TRUE(scene.scene()->nestsMedia) << each.name;
    EXPECT_GT(renderCounted(scene).judged, 0u) << each.name;
  }
}

/// A medium by its extinction is the one by the colour that it leaves, and a dielectric above it bends as without it.
TEST(BodiesWithoutPriority, AMediumMayBeSaidByItsExtinction) {
  const auto render = [](const std::string& medium) {
    const std::string material = R"(<bsdf type="osl"><source><![CDATA[surface inside() {
        Ci = layer(dielectric_bsdf(N, vector(0), color(1), color(1), 0.0, 0.0, 1.5, "ggx"), )" +
                                 medium + "); }]]></source></bsdf>";
    const TestScene scene = loadScene(bounces, view, surroundings + ball(0, 0.8, material));
    EXPECT_TRUE(scene.scene());
    return scene.scene() ? scene.render(64) : nullptr;
  };
  // -log(exp(-1)) / 0.5 is 2.
  const auto byColor = render("medium_vdf(color(0.5), 0.5, color(0.36787944), 0.3, 1.5, 0)");
  const auto byExtinction = render("anisotropic_vdf(color(0.5), color(2), 0.3)");
  const auto clear = render("anisotropic_vdf(color(0.5), color(0), 0.3)");
  ASSERT_TRUE(byColor && byExtinction && clear);
  double sum = 0, difference = 0, without = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      const auto green = [&](const auto& film) { return static_cast<double>(film->estimate(x, y).color.g); };
      sum += green(byColor);
      difference += green(byExtinction) - green(byColor);
      without += green(clear) - green(byColor);
    }
  }
  EXPECT_LT(std::abs(difference), 0.002 * sum);
  EXPECT_GT(without, 0.05 * sum) << "what is inside is seen";
}

}  // namespace
}  // namespace aerosol::test

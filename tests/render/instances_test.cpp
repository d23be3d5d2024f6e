#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "tests/render/film_checks.h"

// Groups of shapes and volumes: each instance is what the same objects are when they are written where they stand.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1, 0.8, 0.6"/></emitter>)";
constexpr const char* fog = R"(<medium type="homogeneous" {}><rgb name="sigma_t" value="0.9"/>
    <rgb name="albedo" value="0.7, 0.8, 0.9"/></medium>)";

std::string placed(const std::string& steps) { return "<transform name=\"to_world\">" + steps + "</transform>"; }

/// What a group holds, with each object's own transform and the one of its instance.
using Content = std::function<std::string(const std::string& outer)>;

void expectSame(const std::string& rest, const Content& content, const std::vector<std::string>& places,
                const std::string& sensorXml = {}) {
  std::string direct = rest, grouped = rest + "<shape type=\"shapegroup\" id=\"group\">" + content("") + "</shape>";
  for (const std::string& place : places) {
    direct += content(place);
    grouped += "<shape type=\"instance\"><ref id=\"group\"/>" + placed(place) + "</shape>";
  }
  const TestSensor sensor{.fov = 50, .medium = sensorXml};
  const TestScene a = loadScene("", sensor, direct), b = loadScene("", sensor, grouped);
  ASSERT_TRUE(a.scene());
  ASSERT_TRUE(b.scene());
  const auto film = a.render(32);
  EXPECT_TRUE(identical(*film, *b.render(32)));
  EXPECT_GT(film->estimate(8, 8).color.r + film->estimate(3, 8).color.r, 0);
}

const std::vector<std::string> twoPlaces = {
    R"(<scale x="0.5" y="0.8" z="0.5"/><translate x="1"/>)",
    R"(<rotate y="1" angle="40"/><scale x="-0.7" y="0.7" z="0.7"/><translate x="-1" y="0.2"/>)"};

TEST(Instances, OfShapesWithMaterials) {
  expectSame(
      sky,
      [](const std::string& outer) {
        return "<shape type=\"cube\">" + placed("<scale value=\"0.6\"/>" + outer) +
               R"(<bsdf type="roughconductor"><float name="alpha" value="0.3"/></bsdf></shape>)" +
               "<shape type=\"sphere\">" + placed("<translate y=\"0.9\"/><scale value=\"0.5\"/>" + outer) +
               R"(<bsdf type="dielectric"/></shape><shape type="disk">)" +
               placed("<rotate x=\"1\" angle=\"-90\"/><translate y=\"-0.7\"/>" + outer) +
               R"(<bsdf type="diffuse"/></shape>)";
      },
      twoPlaces);
}

TEST(Instances, OfVolumesAndOfShapesWithMedia) {
  expectSame(
      sky,
      [](const std::string& outer) {
        return "<volume type=\"sphere\">" + placed("<scale value=\"0.8\"/>" + outer) +
               fmt::format(fmt::runtime(fog), "") + "</volume><shape type=\"cube\">" +
               placed("<scale value=\"0.3\"/><translate y=\"-0.8\"/>" + outer) + "<bsdf type=\"null\"/>" +
               fmt::format(fmt::runtime(fog), "name=\"interior\"") + "</shape>";
      },
      twoPlaces);
}

TEST(Instances, OfWhatShines) {
  expectSame(R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale value="3"/>
                 <translate z="1"/></transform></shape>)",
             [](const std::string& outer) {
               return "<shape type=\"sphere\">" + placed("<scale value=\"0.4\"/>" + outer) +
                      R"(<emitter type="area"><rgb name="radiance" value="3, 2, 1"/></emitter></shape>)";
             },
             {R"(<scale value="0.5"/><translate x="1"/>)", R"(<translate x="-1" y="0.2"/>)"});
}

TEST(Instances, ThatMoveAreBlurredLikeTheirShapes) {
  const std::string shutter = R"(<float name="shutter_close" value="1"/>)";
  const auto animation = [](const std::string& from, const std::string& to) {
    return "<animation name=\"to_world\"><transform time=\"0\">" + from + "</transform><transform time=\"1\">" + to +
           "</transform></animation>";
  };
  const std::string cube = R"(<shape type="cube">{}<bsdf type="diffuse"/></shape>)";
  const std::string from = R"(<rotate z="1" angle="10"/><translate x="-1"/>)",
                    to = R"(<rotate z="1" angle="80"/><translate x="1"/>)";
  const TestSensor sensor{.fov = 50, .medium = shutter};
  const auto film = [&](const std::string& content) {
    const TestScene scene = loadScene("", sensor, sky + content);
    EXPECT_TRUE(scene.scene());
    return scene.scene() ? scene.render(16) : nullptr;
  };
  const auto direct =
      film(fmt::format(fmt::runtime(cube), animation("<scale value=\"0.5\"/>" + from, "<scale value=\"0.5\"/>" + to)));
  const auto grouped =
      film("<shape type=\"shapegroup\" id=\"g\">" + fmt::format(fmt::runtime(cube), placed("<scale value=\"0.5\"/>")) +
           "</shape><shape type=\"instance\"><ref id=\"g\"/>" + animation(from, to) + "</shape>");
  ASSERT_TRUE(direct && grouped);
  EXPECT_TRUE(identical(*direct, *grouped));
  // The other way round: what moves stands in a group that is turned and scaled.
  const std::string turn = R"(<rotate z="1" angle="30"/><scale value="0.5"/><translate y="0.3"/>)";
  const auto inner =
      film("<shape type=\"shapegroup\" id=\"g\">" + fmt::format(fmt::runtime(cube), animation(from, to)) +
           "</shape><shape type=\"instance\"><ref id=\"g\"/>" + placed(turn) + "</shape>");
  const auto flat = film(fmt::format(fmt::runtime(cube), animation(from + turn, to + turn)));
  ASSERT_TRUE(inner && flat);
  EXPECT_TRUE(identical(*inner, *flat));
}

/// A wavy sheet of `side` times `side` squares.
std::string writeSheet(const std::string& name, int side) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream file(path, std::ios::binary);
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; j <= side; ++j) {
      const double x = 2.0 * i / side - 1, y = 2.0 * j / side - 1;
      file << fmt::format("v {} {} {}\nvt {} {}\n", x, y, 0.2 * std::sin(7 * x) * std::cos(5 * y), x, y);
    }
  }
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const int a = i * (side + 1) + j + 1, b = a + side + 1;
      file << fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", a, b, b + 1, a + 1);
    }
  }
  return path.string();
}

TEST(Instances, LargeMeshesAreSharedAndLookTheSame) {
  // As many copies as make up for the price of a structure of their own; files of other names share nothing.
  constexpr int count = 4, side = 110;
  static_assert(2 * side * side * (count - 1) > 1 << 16);
  std::string shared = sky, own = sky;
  for (int i = 0; i < count; ++i) {
    const std::string place = placed(fmt::format(R"(<scale x="{}" y="0.5" z="0.5"/><rotate x="1" y="0.2" angle="{}"/>
        <translate x="{}" y="{}"/>)",
                                                 i % 2 ? -0.5 : 0.4, 30 + 70 * i, i % 2 - 0.5, i / 2 - 0.5));
    const std::string shape = R"(<shape type="obj"><string name="filename" value="{}"/>{}<bsdf type="twosided">
        <bsdf type="diffuse"><texture name="reflectance" type="checkerboard"/></bsdf></bsdf></shape>)";
    shared += fmt::format(fmt::runtime(shape), writeSheet("shared_sheet.obj", side), place);
    own += fmt::format(fmt::runtime(shape), writeSheet(fmt::format("own_sheet_{}.obj", i), side), place);
  }
  const TestSensor sensor{.fov = 30};
  const TestScene a = loadScene("", sensor, shared), b = loadScene("", sensor, own);
  ASSERT_TRUE(a.scene());
  ASSERT_TRUE(b.scene());
  EXPECT_EQ(a.scene()->geometry->mesh(0), a.scene()->geometry->mesh(count - 1));
  EXPECT_TRUE(a.scene()->geometry->sharedPlacement(1));
  EXPECT_NE(b.scene()->geometry->mesh(0), b.scene()->geometry->mesh(count - 1));
  const auto films = std::pair(a.render(32), b.render(32));
  double sum = 0, difference = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const Color one = films.first->estimate(x, y).color, other = films.second->estimate(x, y).color;
      sum += static_cast<double>(one.r);
      difference += std::fabs(static_cast<double>(one.r - other.r));
    }
  }
  EXPECT_GT(sum, 10);
  EXPECT_LT(difference, 0.003 * sum);
}

}  // namespace
}  // namespace aerosol::test

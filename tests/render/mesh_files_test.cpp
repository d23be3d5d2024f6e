#include <fmt/format.h>

#include <fstream>
#include <numbers>

#include "tests/render/film_checks.h"
#include "tests/support/serialized_writer.h"

// Meshes from files, as whole scenes see them.

namespace aerosol::test {
namespace {

std::string writeFile(const std::string& name, const std::string& content) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << content;
  return path.string();
}

/// A square at depth z, from -size to size, that faces the camera at -z.
SerializedMesh square(double size, double z) {
  SerializedMesh mesh;
  mesh.positions = {-size, -size, z, -size, size, z, size, size, z, size, -size, z};
  mesh.corners = {0, 1, 2, 0, 2, 3};
  return mesh;
}

TEST(MeshFiles, ASerializedFileGivesTheMeshThatIsAskedFor) {
  for (const int version : {3, 4}) {
    const std::string file =
        writeFile(fmt::format("lamps{}.serialized", version), serializedFile({square(0.1, -1), square(9, 1)}, version));
    const std::string content = R"(<shape type="serialized"><string name="filename" value="{}"/>
        <integer name="shape_index" value="{}"/><emitter type="area"><rgb name="radiance" value="1, 2, 3"/></emitter>
        </shape>)";
    const TestScene small = loadScene("", {}, fmt::format(fmt::runtime(content), file, 0));
    ASSERT_TRUE(small.scene());
    const Color radiance(1, 2, 3);
    // Half of its side is seen under a tangent of 0.1 / 4, half of the film under that of 10 degrees.
    const auto film = small.render(4096);
    double sum = 0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) sum += static_cast<double>(film->estimate(x, y).color.g) / 256;
    }
    const double part = std::pow(0.025 / std::tan(std::numbers::pi / 18), 2);
    EXPECT_NEAR(sum / (2 * part), 1, 0.012);
    const TestScene large = loadScene("", {}, fmt::format(fmt::runtime(content), file, 1));
    ASSERT_TRUE(large.scene());
    EXPECT_TRUE(shows(large, *large.render(4), [&](const Ray<World>&) { return radiance; }));
  }
}

/// The square from -2 to 2 at depth z that faces the camera, of two triangles. Its vertices carry colours that are
/// linear in x and y, its faces a tint.
std::string colouredSquare(const std::string& name, double z) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "r\n"
      "property float g\nproperty float b\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property float tint_r\nproperty float tint_g\nproperty float tint_b\nend_header\n";
  for (const auto& [x, y] : {std::pair{-2, -2}, {-2, 2}, {2, 2}, {2, -2}})
    text += fmt::format("{} {} {} {} {} 0.5\n", x, y, z, 2 + x, 2 + y);
  return writeFile(name, text + "3 0 1 2 1 2 3\n3 0 2 3 4 5 6\n");
}

std::string shining(const std::string& file, const std::string& attribute, double scale = 1) {
  return fmt::format(R"(<shape type="ply"><string name="filename" value="{}"/><emitter type="area">
      <texture type="mesh_attribute" name="radiance"><string name="name" value="{}"/><float name="scale" value="{}"/>
      </texture></emitter></shape>)",
                     file, attribute, scale);
}

TEST(MeshFiles, ColoursOfVerticesAreInterpolated) {
  const std::string file = colouredSquare("coloured.ply", 0);
  const TestScene scene = loadScene("", {}, shining(file, "vertex_color", 3));
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, *scene.render(4096), [](const Ray<World>& ray) {
    const float t = 5 / ray.direction.z;
    return Color(2 + t * ray.direction.x, 2 + t * ray.direction.y, 0.5f) * 3;
  }));
}

TEST(MeshFiles, ColoursOfFacesAreEven) {
  const std::string file = colouredSquare("tinted.ply", 0);
  const TestScene scene = loadScene("", {.width = 15}, shining(file, "face_tint"));
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(64);
  // Seen from -z with +y up, +x lies on the left: the first face, above the diagonal, is the upper right one.
  const Color upper = film->estimate(14, 1).color, lower = film->estimate(0, 14).color;
  EXPECT_EQ(upper, Color(1, 2, 3));
  EXPECT_EQ(lower, Color(4, 5, 6));
}

TEST(MeshFiles, MaterialsReadThemToo) {
  const std::string file = colouredSquare("painted.ply", 0);
  const std::string content = fmt::format(R"(<emitter type="constant"/><shape type="ply">
      <string name="filename" value="{}"/><bsdf type="diffuse"><texture type="mesh_attribute" name="reflectance">
      <string name="name" value="vertex_color"/><float name="scale" value="0.2"/></texture></bsdf></shape>)",
                                          file);
  const TestScene scene = loadScene("", {}, content);
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, *scene.render(4096), [](const Ray<World>& ray) {
    const float t = 5 / ray.direction.z;
    return Color(2 + t * ray.direction.x, 2 + t * ray.direction.y, 0.5f) * 0.2f;
  }));
}

TEST(MeshFiles, LightFromAColouredMeshIsTheSameByLightsAndByDirections) {
  // The square at z = -7, behind the camera, shines on the wall at z = 0.
  const std::string file = colouredSquare("lamp.ply", 0);
  const std::string wall = R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/>
      <scale value="3"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>)";
  const auto lamp = [&](const std::string& inside) {
    return wall + fmt::format(R"(<shape type="ply"><string name="filename" value="{}"/><transform name="to_world">
        <rotate y="1" angle="180"/><translate x="0" y="0" z="-7"/></transform>{}</shape>)",
                              file, inside);
  };
  const std::string reading = R"(<texture type="mesh_attribute" name="{}"><string name="name" value="vertex_color"/>
      </texture>)";
  const TestSensor sensor{.origin = "0, 0, -5", .fov = 30};
  const std::string depth = R"(<integer name="max_depth" value="2"/>)";
  const TestScene sampled = loadScene(
      depth, sensor, lamp("<emitter type=\"area\">" + fmt::format(fmt::runtime(reading), "radiance") + "</emitter>"));
  // A material that glows is no light: its light is found by directions alone.
  const TestScene found =
      loadScene(depth, {.origin = "0, 0, -5", .fov = 30, .seed = 1},
                lamp(R"(<bsdf type="glow">)" + fmt::format(fmt::runtime(reading), "radiance") + "</bsdf>"));
  ASSERT_TRUE(sampled.scene());
  ASSERT_TRUE(found.scene());
  EXPECT_TRUE(showTheSame(*sampled.render(1024), *found.render(8192)));
}

TEST(MeshFiles, AnAttributeThatIsMissingIsReported) {
  const std::string file = colouredSquare("plain.ply", 0);
  const TestScene scene = loadScene("", {}, shining(file, "vertex_tint"));
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(1);
  const auto messages = scene.scene()->messages->sorted();
  ASSERT_FALSE(messages.empty());
  EXPECT_NE(messages[0].text.find("there is no attribute 'vertex_tint' on this shape"), std::string::npos);
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include <fstream>

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
    // The square of side 0.2 at z = -1, seen from z = -5: each pixel's mean is the part that it covers.
    EXPECT_TRUE(shows(
        small, *small.render(4096),
        [&](const Ray<World>& ray) {
          const float t = 4 / ray.direction.z;
          const bool isHit = std::fabs(t * ray.direction.x) < 0.1f && std::fabs(t * ray.direction.y) < 0.1f;
          return isHit ? radiance : Color();
        },
        1));
    const TestScene large = loadScene("", {}, fmt::format(fmt::runtime(content), file, 1));
    ASSERT_TRUE(large.scene());
    EXPECT_TRUE(shows(large, *large.render(4), [&](const Ray<World>&) { return radiance; }));
  }
}

}  // namespace
}  // namespace aerosol::test

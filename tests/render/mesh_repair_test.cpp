#include <fmt/format.h>

#include <fstream>

#include "core/accel/mesh.h"
#include "tests/render/film_checks.h"
#include "tests/support/scratch_folder.h"

// Coloured glass in a mesh with faces that are turned or missing: no light leaks, the image is that of the whole body,
// and it is told.

namespace aerosol::test {
namespace {

class MeshRepairs : public ::testing::Test {
 protected:
  void write(const std::string& name, const accel::TriangleMesh& mesh) const {
    std::ofstream out(scratch_.path() / name);
    out << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Point<World>& p : mesh.positions) out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  }

  TestScene load(const std::string& shape, int seed, bool mayWarn) const {
    return loadScene(R"(<integer name="max_depth" value="12"/>)",
                     {.origin = "2, 3, -6", .fov = 34, .width = 16, .height = 16, .seed = seed},
                     fmt::format(R"(<emitter type="constant"><rgb name="radiance" value="1, 0.8, 0.5"/></emitter>
        <shape type="{}<transform name="to_world"><rotate y="1" angle="20"/></transform>
        <bsdf type="dielectric"><float name="ior" value="1.3"/><float name="transmission_depth" value="1"/>
        <rgb name="transmission_color" value="0.5, 0.7, 0.9"/><integer name="priority" value="1"/></bsdf></shape>)",
                                 shape),
                     {.mayWarn = mayWarn});
  }
  std::string ply(const std::string& name) const {
    return fmt::format(R"(ply"><boolean name="face_normals" value="true"/><string name="filename" value="{}"/>)",
                       (scratch_.path() / name).string());
  }

  void expectTheWholeCube(const accel::TriangleMesh& mesh, const char* told) const {
    write("body.ply", mesh);
    const TestScene whole = load("cube\">", 0, false), mended = load(ply("body.ply"), 1, true);
    ASSERT_TRUE(whole.scene() && mended.scene());
    EXPECT_NE(mended.warnings().find(told), std::string::npos) << mended.warnings();
    const auto expected = whole.render(512), film = mended.film();
    const auto report = mended.renderInto(*film, {.threads = 1, .endSample = 512});
    EXPECT_TRUE(showTheSame(*expected, *film));
    EXPECT_EQ(report.statistics.media.exitsWithoutEntry + report.statistics.media.repeatedEntries, 0u);
  }

  ScratchFolder scratch_;
};

TEST_F(MeshRepairs, FacesThatLookInwards) {
  accel::TriangleMesh mesh = accel::makeCube();
  for (const std::size_t t : {std::size_t{0}, std::size_t{5}, std::size_t{6}})
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  expectTheWholeCube(mesh, "3 of the 12 triangles of this mesh disagree");
}

TEST_F(MeshRepairs, FacesThatAreMissing) {
  accel::TriangleMesh mesh = accel::makeCube();
  mesh.triangles.erase(mesh.triangles.begin() + 4, mesh.triangles.begin() + 6);
  mesh.triangles.pop_back();
  expectTheWholeCube(mesh, "has 2 holes");
}

/// As it is modelled, where that is asked for: rays that come out where they never went in are counted.
TEST_F(MeshRepairs, AreNotDoneWhereTheyAreNotWanted) {
  accel::TriangleMesh mesh = accel::makeCube();
  std::erase_if(mesh.triangles, [i = 0](const auto&) mutable { return i++ % 2 == 0; });
  write("open.ply", mesh);
  const TestScene scene = load(ply("open.ply") + R"(<boolean name="repair" value="false"/>)", 0, false);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.film();
  const auto report = scene.renderInto(*film, {.threads = 1, .endSample = 64});
  EXPECT_GT(report.statistics.media.exitsWithoutEntry, 0u);
}

}  // namespace
}  // namespace aerosol::test

#include <fmt/format.h>

#include <cmath>

#include "core/accel/double3.h"
#include "core/app/doctor/mesh_check.h"
#include "tests/render/film_checks.h"

// Displacement shaders: where they move the vertices of a shape, how finely, and what is around them.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1, 0.8, 0.6"/></emitter>)";

std::string inlined(const std::string& body, const std::string& fields = {}, const std::string& parameters = {}) {
  return "<displacement type=\"osl\">" + fields + "<source><![CDATA[displacement moved(" + parameters + ") { " + body +
         " }]]></source></displacement>";
}

std::string shape(const std::string& type, const std::string& inside) {
  return "<shape type=\"" + type + "\">" + inside + "</shape>";
}

TestScene sceneOf(const std::string& content, TestSensor sensor = {}, bool mayWarn = false) {
  sensor.fov = 50;
  return loadScene("", sensor, sky + content, {.mayWarn = mayWarn});
}

const accel::TriangleMesh& meshOf(const TestScene& scene, accel::ObjectId object = 0) {
  return *scene.scene()->geometry->mesh(object);
}

double longestEdge(const accel::TriangleMesh& mesh) {
  double longest = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i)
      longest = std::fmax(
          longest, length(accel::toDouble(mesh.positions[t[i]]) - accel::toDouble(mesh.positions[t[(i + 1) % 3]])));
  }
  return longest;
}

constexpr const char* onePerLevel = R"(<integer name="levels" value="4"/>)";

TEST(Displacement, MovesEveryKindOfShapeAlongItsNormal) {
  for (const char* type : {"sphere", "cylinder", "cube"}) {
    const TestScene scene = sceneOf(shape(type, inlined("P += 0.5 * N;", onePerLevel)));
    ASSERT_TRUE(scene.scene()) << type;
    const accel::TriangleMesh& mesh = meshOf(scene);
    EXPECT_GT(mesh.triangles.size(), 1000u);
    for (const Point<World>& p : mesh.positions) {
      const double x = std::fabs(static_cast<double>(p.x)), y = std::fabs(static_cast<double>(p.y)),
                   z = std::fabs(static_cast<double>(p.z));
      const double distance = type == std::string("sphere")     ? std::sqrt(x * x + y * y + z * z)
                              : type == std::string("cylinder") ? std::hypot(x, y)
                                                                : std::fmax(x, std::fmax(y, z));
      // Where faces of the cube meet there is a mean of what they want.
      EXPECT_LE(distance, 1.5 + 1e-6);
      EXPECT_GE(distance, type == std::string("cube") ? 1 + 0.5 / 3 - 1e-6 : 1.5 - 1e-6);
    }
  }
}

TEST(Displacement, OfAPlaneAsAWholeIsThePlaneElsewhere) {
  const std::string place = R"(<transform name="to_world"><rotate y="1" angle="180"/>{}</transform>)";
  const TestScene moved = sceneOf(
                      shape("rectangle", fmt::format(fmt::runtime(place), "") + inlined("P += 0.5 * N;", onePerLevel))),
                  other = sceneOf(shape("rectangle", fmt::format(fmt::runtime(place), "<translate z=\"-0.5\"/>")));
  ASSERT_TRUE(moved.scene() && other.scene());
  const auto a = moved.render(16), b = other.render(16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x)
      EXPECT_NEAR(a->estimate(x, y).color.g, b->estimate(x, y).color.g, 1e-4) << x << ' ' << y;
  }
}

TEST(Displacement, EdgesAreAsLongAsAskedFor) {
  const std::string bump = "P += 0.4 * exp(-8 * dot(P, P)) * N;";
  const TestScene scene = sceneOf(shape("rectangle", inlined(bump, R"(<float name="edge_length" value="0.11"/>)")));
  ASSERT_TRUE(scene.scene());
  const accel::TriangleMesh& mesh = meshOf(scene);
  EXPECT_LE(longestEdge(mesh), 0.11);
  EXPECT_LT(mesh.triangles.size(), 8000u);
}

TEST(Displacement, EdgesAreShortInThePictureAndLongerElsewhere) {
  const std::string plane = R"(<transform name="to_world"><rotate x="1" angle="-90"/><scale value="30"/>
      <translate y="-1"/></transform>)";
  const TestScene scene =
      sceneOf(shape("rectangle", plane + inlined("P += vector(0, 0.05 * sin(3 * P[0]) * cos(2 * P[2]), 0);",
                                                 R"(<float name="edge_pixels" value="1.5"/>)")),
              {.origin = "0, 0, 0", .target = "0, -0.3, 1", .width = 24, .height = 24});
  ASSERT_TRUE(scene.scene());
  const accel::TriangleMesh& mesh = meshOf(scene);
  const render::Camera& camera = *scene.scene()->camera;
  const auto toCamera = camera.toWorld(0).inverse();
  const auto view = camera.view();
  const double pixel = (view.x1 - view.x0) / 24;
  std::size_t seen = 0;
  double outside = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Point<World> a = mesh.positions[t[i]], b = mesh.positions[t[(i + 1) % 3]];
      const Point<Camera> p = toCamera(a);
      const double z = static_cast<double>(p.z), x = static_cast<double>(p.x), y = static_cast<double>(p.y);
      const double pixels = static_cast<double>(length(a - b)) / (pixel * std::hypot(x, y, z));
      if (z > 0 && x > view.x0 * z && x < view.x1 * z && y > view.y0 * z && y < view.y1 * z) {
        ++seen;
        EXPECT_LE(pixels, 1.5 + 1e-3);
      } else {
        outside = std::fmax(outside, pixels);
      }
    }
  }
  EXPECT_GT(seen, 500u);
  EXPECT_GT(outside, 4);
  EXPECT_LE(outside, 12 + 1e-3);
}

TEST(Displacement, NoCracksOpenWhereVerticesAreSeveral) {
  // Noise by texture coordinates differs on both sides of a seam.
  const std::string rough = "P += 0.2 * noise(\"snoise\", 7 * u, 5 * v + P[0]) * N;";
  for (const char* type : {"sphere", "cube"}) {
    const TestScene scene = sceneOf(shape(type, inlined(rough, R"(<float name="edge_length" value="0.1"/>)")));
    ASSERT_TRUE(scene.scene());
    EXPECT_FALSE(app::checkMesh(meshOf(scene)).any()) << type;
  }
}

TEST(Displacement, NormalsAreThoseOfTheNewSurface) {
  // Height 0.2 sin(3 x) cos(2 y); the shader's own normals by its derivatives, and those of the triangles.
  const std::string relief = "P += 0.2 * sin(3 * P[0]) * cos(2 * P[1]) * vector(0, 0, 1);";
  for (const bool writes : {false, true}) {
    const TestScene scene =
        sceneOf(shape("rectangle", inlined(relief + (writes ? "N = normalize(calculatenormal(P));" : ""),
                                           R"(<integer name="levels" value="6"/>)")));
    ASSERT_TRUE(scene.scene());
    const accel::TriangleMesh& mesh = meshOf(scene);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const double x = static_cast<double>(mesh.positions[i].x), y = static_cast<double>(mesh.positions[i].y);
      if (std::fmax(std::fabs(x), std::fabs(y)) > 0.99 && !writes) continue;  // One-sided at the border.
      const accel::Double3 normal = normalize(
          accel::Double3{-0.6 * std::cos(3 * x) * std::cos(2 * y), 0.4 * std::sin(3 * x) * std::sin(2 * y), 1});
      EXPECT_NEAR(length(accel::toDouble(mesh.normals[i]) - normal), 0, writes ? 1e-4 : 5e-3) << x << ' ' << y;
    }
  }
}

TEST(Displacement, TakesTexturesAttributesAndParameters) {
  const std::string checkered = R"(<displacement type="height"><float name="scale" value="2"/>
      <float name="middle" value="0.25"/><float name="edge_length" value="0.2"/>
      <texture type="checkerboard"><rgb name="color0" value="0.25"/><rgb name="color1" value="0.75"/></texture>
      </displacement>)";
  const TestScene textured = sceneOf(shape("rectangle", checkered));
  ASSERT_TRUE(textured.scene());
  std::size_t low = 0, high = 0;
  for (const Point<World>& p : meshOf(textured).positions) {
    low += std::fabs(p.z) < 1e-5f;
    high += std::fabs(p.z - 1) < 1e-5f;
  }
  EXPECT_EQ(low + high, meshOf(textured).positions.size());
  EXPECT_GT(std::min(low, high), 100u);

  const std::string asked = inlined(
      "float age = 0; getattribute(\"user:age\", age); P[2] += age + (raytype(\"displacement\") ? 1 : 0) + more;",
      onePerLevel + std::string(R"(<float name="more" value="0.25"/>)"), "float more = 0");
  const TestScene told = sceneOf(shape("rectangle", R"(<float name="user:age" value="3"/>)" + asked));
  ASSERT_TRUE(told.scene());
  for (const Point<World>& p : meshOf(told).positions) EXPECT_EQ(p.z, 4.25f);
}

TEST(Displacement, WorksInTheWorldAndFollowsMirrors) {
  const std::string mirrored =
      R"(<transform name="to_world"><scale x="-2" y="2" z="2"/><translate x="1"/></transform>)";
  const TestScene scene = sceneOf(shape("sphere", mirrored + inlined("P += 0.5 * N;", onePerLevel)));
  ASSERT_TRUE(scene.scene());
  const accel::TriangleMesh& mesh = meshOf(scene);
  double volume = 0;
  for (const auto& t : mesh.triangles)
    volume += dot(accel::toDouble(mesh.positions[t[0]]),
                  cross(accel::toDouble(mesh.positions[t[1]]), accel::toDouble(mesh.positions[t[2]]))) /
              6;
  EXPECT_NEAR(volume, 4.18879 * 2.5 * 2.5 * 2.5, 0.3);  // The outside is still outside.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_NEAR(std::hypot(mesh.positions[i].x - 1, mesh.positions[i].y, mesh.positions[i].z), 2.5f, 1e-5f);
}

TEST(Displacement, OfShapesThatMoveKeepsItsForm) {
  const std::string shutter = R"(<animation name="to_world"><transform time="0"><translate x="-1"/></transform>
      <transform time="1"><translate x="1"/></transform></animation>)";
  const auto film = [&](const std::string& content) {
    return TestScene(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"shutter_close\" value=\"1\"/>"
        "<transform name=\"to_world\"><lookat origin=\"0,0,-5\" target=\"0,0,0\" up=\"0,1,0\"/></transform>"
        "<film type=\"hdrfilm\"><integer name=\"width\" value=\"8\"/><integer name=\"height\" value=\"8\"/>"
        "<rfilter type=\"box\"/></film><sampler type=\"independent\"/></sensor>" +
        std::string(sky) + content + "</scene>");
  };
  const TestScene displaced =
      film(shape("sphere", shutter + "<float name=\"radius\" value=\"0.5\"/>" +
                               inlined("P += 0.25 * N;", R"(<integer name="levels" value="5"/>)")));
  const TestScene plain = film(shape("sphere", shutter + "<float name=\"radius\" value=\"0.75\"/>"));
  ASSERT_TRUE(displaced.scene() && plain.scene());
  EXPECT_TRUE(showTheSame(*displaced.render(256), *plain.render(256), 0.02));
}

TEST(Displacement, PointsThatGoNowhereStayAndAreTold) {
  const std::string broken = inlined("if (P[0] > 0.4) P[2] = exp(1000 * P[0]);", onePerLevel);
  const TestScene scene = sceneOf(shape("rectangle", broken), {}, true);
  ASSERT_TRUE(scene.scene());
  for (const Point<World>& p : meshOf(scene).positions) EXPECT_EQ(p.z, 0);
}

TEST(Displacement, LightsShineFromTheNewSurface) {
  // From a sphere of radius 1/2 that was blown up to 1, upon a plane at distance 2 from its centre.
  const std::string ground = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="0.05"/><translate y="-2"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>
      </shape>)";
  const std::string light = shape("sphere", R"(<float name="radius" value="0.5"/>
      <emitter type="area"><rgb name="radiance" value="1"/></emitter>)" +
                                                inlined("P += 0.5 * N;", R"(<integer name="levels" value="4"/>)"));
  const TestScene scene =
      loadScene(R"(<integer name="max_depth" value="2"/>)",
                {.origin = "0.5, -1.9, 0", .target = "0, -2, 0", .fov = 1, .width = 4, .height = 4}, ground + light);
  ASSERT_TRUE(scene.scene());
  // Irradiance of a sphere seen under the angle asin(1/2) overhead: π sin², reflected: sin².
  EXPECT_TRUE(shows(scene, *scene.render(2048), [](const Ray<World>&) { return Color(0.25f); }, 0.01));
}

}  // namespace
}  // namespace aerosol::test

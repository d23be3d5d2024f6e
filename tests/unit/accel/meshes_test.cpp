// Meshes as they are built in, and what a scene refuses.

#include "tests/unit/accel/surface_reference.h"

namespace aerosol::accel {
namespace {

TEST(Builder, RefusesWhatItCannotUse) {
  SceneBuilder builder;
  TriangleMesh mesh = makeRectangle();
  mesh.triangles.push_back({0, 1, 4});
  auto object = builder.addMesh(mesh);
  ASSERT_FALSE(object);
  EXPECT_EQ(object.errors().entries()[0].message, "triangle 2 names vertex 4, but the mesh has 4");
  mesh = makeRectangle();
  mesh.positions[2].y = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(builder.addMesh(mesh));
  mesh = makeRectangle();
  mesh.normals.pop_back();
  EXPECT_FALSE(builder.addMesh(mesh));
  mesh = makeRectangle(translateScale(0, 0, 0, 1e30));
  EXPECT_FALSE(builder.addMesh(mesh));
  Matrix4 flat = identityMatrix();
  flat[2][2] = 0;
  EXPECT_FALSE(builder.addSphere(Transform<World, Object>(flat, identityMatrix())));
  flat[2][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(builder.addDisk(Transform<World, Object>(flat, identityMatrix())));
  const Scene scene = build(builder);
  EXPECT_EQ(scene.objectCount(), 0u);
  EXPECT_TRUE(scene.bounds().isEmpty());
  Buffers buffers;
  EXPECT_FALSE(scene.closestHit({{0, 0, -3}, {0, 0, 1}}, buffers.spans, buffers.counters));
}

TEST(Mesh, CubeAndRectangleFaceOutwards) {
  Random random("Mesh.Outwards");
  for (int k = 0; k < 50; ++k) {
    const auto toWorld = k == 0 ? Transform<World, Object>() : randomTransform(random, 3, 1);
    const TriangleMesh cube = makeCube(toWorld);
    const Point<World> centre = toWorld(Point<Object>());
    ASSERT_EQ(cube.triangles.size(), 12u);
    for (const auto& t : cube.triangles) {
      const Point<World> a = cube.positions[t[0]];
      const Vector<World> n = cross(cube.positions[t[1]] - a, cube.positions[t[2]] - a);
      EXPECT_GT(dot(n, a - centre), 0);
      for (const std::uint32_t corner : t) EXPECT_NEAR(dot(normalize(n), cube.normals[corner]), 1, 1e-5);
    }
    const TriangleMesh rectangle = makeRectangle(toWorld);
    const Normal<World> up = normalize(toWorld(Normal<Object>(0, 0, 1)));
    for (const auto& t : rectangle.triangles) {
      const Point<World> a = rectangle.positions[t[0]];
      EXPECT_NEAR(dot(normalize(cross(rectangle.positions[t[1]] - a, rectangle.positions[t[2]] - a)), up), 1, 1e-5);
    }
  }
}

TEST(Mesh, NormalsAreSmoothedFlippedOrFlat) {
  // A closed octahedron: by symmetry each smooth normal points along its axis.
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  TriangleMesh smooth = mesh;
  resolveNormals(smooth);
  ASSERT_EQ(smooth.normals.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(dot(mesh.positions[i] - Point<World>(), smooth.normals[i]), 1, 1e-6);

  TriangleMesh flipped = mesh;
  flipped.flipNormals = true;
  SceneBuilder builder;
  ASSERT_TRUE(builder.addMesh(flipped));
  mesh.faceNormals = true;
  ASSERT_TRUE(builder.addMesh(mesh));
  const Scene scene = build(builder);
  EXPECT_TRUE(scene.mesh(1)->normals.empty());
  Buffers buffers;
  const Ray<World> ray{{0.125f, 0.25f, 3}, {0, 0, -1}};
  auto hit = scene.closestHit(ray, buffers.spans, buffers.counters);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->object, 0u);
  EXPECT_FALSE(hit->entering);
  EXPECT_LT(hit->geometricNormal.z, 0);
  EXPECT_LT(hit->shadingNormal.z, -0.75f);
  const HitKey key = hit->key();
  hit = scene.closestHit(ray, buffers.spans, buffers.counters, &key);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->object, 1u);
  EXPECT_TRUE(hit->entering);
  EXPECT_NEAR(hit->shadingNormal.z, 1 / std::sqrt(3.0f), 1e-6);
}

TEST(Mesh, TrianglesTurnToTheSideOfTheirNormals) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}};  // The second one faces -z.
  const auto original = mesh.triangles;
  windByNormals(mesh);
  EXPECT_EQ(mesh.triangles, original);
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  windByNormals(mesh);
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {1, 3, 2}}));
  // Corners that do not agree leave a triangle as it is.
  mesh.normals = {{0, 0, -1}, {0, 0, -1}, {0, 0, 1}, {0, 0, -1}};
  windByNormals(mesh);
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {1, 3, 2}}));
}

}  // namespace
}  // namespace aerosol::accel

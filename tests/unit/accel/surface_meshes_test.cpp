// Queries of triangles against double-precision brute force over every one; edges, vertices, doubled faces.

#include "tests/unit/accel/surface_reference.h"

namespace aerosol::accel {
namespace {

TEST(Surfaces, RandomMeshesAgreeWithBruteForce) {
  Random random("Surfaces.RandomMeshesAgreeWithBruteForce");
  SceneBuilder builder;
  std::vector<TriangleMesh> meshes;
  for (int i = 0; i < 5; ++i) {
    meshes.push_back(randomMesh(random, 100));
    ASSERT_EQ(*builder.addMesh(meshes.back()), static_cast<ObjectId>(i));
  }
  const Scene scene = build(builder);
  Buffers buffers;
  int hits = 0, compared = 0;
  for (int k = 0; k < 20'000; ++k) {
    Ray<World> ray{random.point(15), random.direction()};
    if (k % 3 == 0) ray.tMin = random.uniformFloat(0, 10);
    if (k % 2 == 0) ray.tMax = ray.tMin + random.uniformFloat(0, 10);
    Reference reference;
    for (ObjectId object = 0; object < meshes.size(); ++object) {
      for (std::uint32_t i = 0; i < meshes[object].triangles.size(); ++i) {
        testTriangle(meshes[object], object, i, ray, reference);
      }
    }
    if (reference.margin < 1e-6L) continue;
    ++compared;
    const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters);
    ASSERT_EQ(hit.has_value(), std::isfinite(reference.t)) << k;
    ASSERT_EQ(scene.occluded(ray, buffers.spans, buffers.interfaces, buffers.counters), hit.has_value());
    if (!hit) continue;
    ++hits;
    EXPECT_EQ(hit->object, reference.object);
    EXPECT_EQ(hit->primitive, reference.primitive);
    EXPECT_NEAR(hit->t, static_cast<double>(reference.t), 1e-9 * hit->t);
    const Point<World> onRay = pointAt(ray, hit->t);
    EXPECT_NEAR(length(hit->point - onRay), 0, 4e-6);
    EXPECT_EQ(hit->entering, dot(ray.direction, hit->geometricNormal) < 0);
  }
  EXPECT_GT(compared, 19'000);
  EXPECT_GT(hits, 2'500);
  EXPECT_EQ(buffers.counters.closestHitQueries, static_cast<std::uint64_t>(compared));
}

TEST(Surfaces, EdgesVerticesAndDoubledFacesAreCrossedOnce) {
  SceneBuilder builder;
  TriangleMesh cube = makeCube();
  const auto once = cube.triangles;
  cube.triangles.insert(cube.triangles.end(), once.begin(), once.end());
  ASSERT_TRUE(builder.addMesh(cube, true));
  ASSERT_TRUE(builder.addMesh(makeCube(), true));
  const Scene scene = build(builder);
  Random random("Surfaces.Once");
  Buffers buffers;
  for (int k = 0; k < 20'000; ++k) {
    // From inside through the diagonal of a face, an edge or a corner; from outside back in the first two cases.
    const float s = random.uniformFloat(-0.99, 0.99);
    const int kind = k % 3;
    const Point<World> target = kind == 0   ? Point<World>{s, s, 1}
                                : kind == 1 ? Point<World>{s, 1, 1}
                                            : Point<World>{1, 1, 1};
    const Point<World> inside = k % 2 == 0 ? Point<World>{0, 0, 0} : random.point(0.5);
    const Ray<World> ray{inside, normalize(target - inside)};
    ASSERT_FALSE(scene.occluded(ray, buffers.spans, buffers.interfaces, buffers.counters));
    ASSERT_EQ(buffers.interfaces.size(), 2u) << k;
    EXPECT_NE(buffers.interfaces[0].key.object, buffers.interfaces[1].key.object);
    std::vector<HitKey> keys;
    std::optional<HitKey> after;
    while (const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters, after ? &*after : nullptr)) {
      EXPECT_FALSE(hit->entering);
      keys.push_back(hit->key());
      after = hit->key();
    }
    EXPECT_GE(keys.size(), 2u);
    if (kind == 0) EXPECT_EQ(keys.size(), 2u) << k;
  }
  // Straight through the diagonals of two opposite faces.
  const Ray<World> through{{0, 0, 5}, {0, 0, -1}};
  ASSERT_FALSE(scene.occluded(through, buffers.spans, buffers.interfaces, buffers.counters));
  ASSERT_EQ(buffers.interfaces.size(), 4u);
  EXPECT_TRUE(buffers.interfaces[0].entering && buffers.interfaces[1].entering);
  EXPECT_FALSE(buffers.interfaces[2].entering || buffers.interfaces[3].entering);
}

TEST(Surfaces, RaysParallelToATriangleAndDegenerateTrianglesMiss) {
  SceneBuilder builder;
  TriangleMesh mesh = makeRectangle();
  mesh.triangles.push_back({0, 1, 1});
  mesh.triangles.push_back({2, 2, 2});
  ASSERT_TRUE(builder.addMesh(mesh));
  const Scene scene = build(builder);
  Buffers buffers;
  EXPECT_FALSE(scene.closestHit({{-5, 0.25f, 0}, {1, 0, 0}}, buffers.spans, buffers.counters));
  EXPECT_FALSE(scene.closestHit({{-5, 0.25f, 0}, {1, -0.0f, -0.0f}}, buffers.spans, buffers.counters));
  const auto hit = scene.closestHit({{0.5f, -0.5f, 3}, {-0.0f, 0, -1}}, buffers.spans, buffers.counters);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->t, 3);
  EXPECT_EQ(hit->u, 0.75f);
  EXPECT_EQ(hit->v, 0.25f);
  EXPECT_EQ(hit->dPdu, (Vector<World>{2, 0, 0}));
  EXPECT_EQ(hit->dPdv, (Vector<World>{0, 2, 0}));
}

TEST(Surfaces, NoRayPassesThroughEdgesAndVerticesOfAClosedMesh) {
  SceneBuilder builder;
  const TriangleMesh cube = makeCube();
  ASSERT_TRUE(builder.addMesh(cube));
  const Scene scene = build(builder);
  Random random("Surfaces.Watertight");
  Buffers buffers;
  for (int k = 0; k < 20'000; ++k) {
    const auto& triangle = cube.triangles[random.bits() % cube.triangles.size()];
    const Point<World> a = cube.positions[triangle[0]], b = cube.positions[triangle[1]];
    const Point<World> target = k % 4 == 0 ? a : a + (b - a) * random.uniformFloat(0, 1);
    const Point<World> inside = random.point(0.9);
    const Ray<World> ray{inside, normalize(target - inside)};
    const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters);
    ASSERT_TRUE(hit) << k;
    EXPECT_FALSE(hit->entering);
  }
}

}  // namespace
}  // namespace aerosol::accel

// Instances of shared meshes against the same triangles in the world.

#include <gtest/gtest.h>

#include "core/accel/scene.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {
namespace {

constexpr std::size_t instances = 12;

/// Small triangles around `centre`, with normals and texture coordinates.
TriangleMesh scatteredMesh(Random& random, Point<World> centre) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const Point<World> corner = centre + (random.point(1) - Point<World>());
    Vector<World> edges[2];
    for (Vector<World>& edge : edges) edge = random.point(0.3) - Point<World>();
    const Point<World> corners[3] = {corner, corner + edges[0], corner + edges[1]};
    const Vector<World> across = cross(edges[0], edges[1]);
    for (const Point<World>& p : corners) {
      mesh.positions.push_back(p);
      const Vector<World> bent = normalize(across) + 0.2f * (random.point(1) - Point<World>());
      mesh.normals.push_back(normalize(Normal<World>(bent.x, bent.y, bent.z)));
      mesh.uvs.push_back({random.uniformFloat(0, 1), random.uniformFloat(0, 1)});
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// Turned, stretched, half of them mirrored; what is around `centre` comes to within 3 of the origin.
Transform<World, Object> randomPlace(Random& random, Point<World> centre) {
  const Transform<World, Object> place = randomTransform(random, 3, 1);
  const Transform<World, Object> back =
      translateScale(-static_cast<double>(centre.x), -static_cast<double>(centre.y), -static_cast<double>(centre.z));
  return {multiply(place.matrix(), back.matrix()), multiply(back.inverseMatrix(), place.inverseMatrix())};
}

Vector<World> vector(Normal<World> n) { return {n.x, n.y, n.z}; }

struct Pair {
  std::optional<Scene> shared, copied;
};

Pair makePair(Random& random, Point<World> centre, bool passThrough) {
  const TriangleMesh mesh = scatteredMesh(random, centre);
  SceneBuilder shared, copied;
  const auto id = shared.addShared(mesh);
  EXPECT_TRUE(id);
  for (std::size_t i = 0; i < instances; ++i) {
    const Transform<World, Object> place = randomPlace(random, centre);
    EXPECT_TRUE(shared.addInstance(*id, place, passThrough));
    TriangleMesh copy = mesh;
    transformMesh(copy, place);
    EXPECT_TRUE(copied.addMesh(std::move(copy), passThrough));
  }
  auto a = shared.build(), b = copied.build();
  EXPECT_TRUE(a && b);
  return {std::move(*a), std::move(*b)};
}

Ray<World> randomRay(Random& random) {
  const Point<World> from = random.point(8), to = random.point(3);
  return {from, to - from};
}

/// Rounded to float, the corners of a copy are not the mesh's own: some rays near edges differ.
struct Agreement {
  int rays = 0, different = 0, hits = 0;
};

void compareHits(const SurfaceHit& a, const SurfaceHit& b, float scale, Agreement& agreement) {
  ++agreement.hits;
  if (a.object != b.object || a.primitive != b.primitive) {
    ++agreement.different;
    return;
  }
  EXPECT_EQ(a.entering, b.entering);
  EXPECT_NEAR(length(a.point - b.point), 0, 1e-5f * scale);
  EXPECT_GT(dot(vector(a.geometricNormal), b.geometricNormal), 1 - 1e-4f * scale);
  EXPECT_GT(dot(vector(a.geometricNormal), a.shadingNormal), 0);
  EXPECT_NEAR(a.u, b.u, 1e-3f * scale);
  EXPECT_NEAR(a.v, b.v, 1e-3f * scale);
}

TEST(SharedMesh, InstancesAreMetLikeCopies) {
  Random random("SharedMesh.InstancesAreMetLikeCopies");
  SpanBuffer spans;
  Counters counters;
  const Pair scenes = makePair(random, {0, 0, 0}, false);
  EXPECT_EQ(scenes.shared->mesh(0), scenes.shared->mesh(instances - 1));
  Agreement agreement;
  for (int i = 0; i < 20000; ++i) {
    const Ray<World> ray = randomRay(random);
    const auto a = scenes.shared->closestHit(ray, spans, counters);
    const auto b = scenes.copied->closestHit(ray, spans, counters);
    ++agreement.rays;
    if (a && b) {
      compareHits(*a, *b, 1, agreement);
    } else {
      agreement.different += a.has_value() != b.has_value();
    }
    InterfaceBuffer interfaces;
    EXPECT_EQ(scenes.shared->occluded(ray, spans, interfaces, counters), a.has_value());
  }
  EXPECT_GT(agreement.hits, 3000);
  EXPECT_LE(agreement.different, 4);
}

TEST(SharedMesh, AllHitsAlongARayComeInTheirOrder) {
  Random random("SharedMesh.AllHitsAlongARayComeInTheirOrder");
  SpanBuffer spans;
  Counters counters;
  const Pair scenes = makePair(random, {0, 0, 0}, true);
  int hits = 0, different = 0;
  for (int i = 0; i < 3000; ++i) {
    const Ray<World> ray = randomRay(random);
    const auto walk = [&](const Scene& scene) {
      std::vector<HitKey> keys;
      for (auto hit = scene.closestHit(ray, spans, counters); hit && keys.size() < 10000;
           hit = scene.closestHit(ray, spans, counters, &keys.back())) {
        if (!keys.empty()) EXPECT_LT(keys.back(), hit->key());
        keys.push_back(hit->key());
      }
      return keys;
    };
    const std::vector<HitKey> a = walk(*scenes.shared), b = walk(*scenes.copied);
    hits += static_cast<int>(a.size());
    different += a.size() != b.size();
    InterfaceBuffer interfaces;
    EXPECT_FALSE(scenes.shared->occluded(ray, spans, interfaces, counters));
    EXPECT_EQ(interfaces.size(), a.size());
  }
  EXPECT_GT(hits, 3000);
  EXPECT_LE(different, 6);
}

/// A mesh far from its own origin has coarse corners, and its instance must not meet itself where a ray leaves it.
TEST(SharedMesh, RaysThatLeaveAnInstanceDoNotMeetTheirOwnFace) {
  Random random("SharedMesh.RaysThatLeaveAnInstanceDoNotMeetTheirOwnFace");
  SpanBuffer spans;
  Counters counters;
  const Pair scenes = makePair(random, {3000, -2000, 5000}, false);
  int left = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto hit = scenes.shared->closestHit(randomRay(random), spans, counters);
    if (!hit) continue;
    const Vector<World> direction = random.point(1) - Point<World>();
    const Ray<World> away{hit->originTowards(direction), direction};
    const auto next = scenes.shared->closestHit(away, spans, counters);
    ++left;
    EXPECT_FALSE(next && next->object == hit->object && next->primitive == hit->primitive);
  }
  EXPECT_GT(left, 3000);
}

TEST(SharedMesh, WhatCannotBePlacedIsAnError) {
  SceneBuilder builder;
  Random random("SharedMesh.WhatCannotBePlacedIsAnError");
  const auto id = builder.addShared(scatteredMesh(random, {0, 0, 0}));
  ASSERT_TRUE(id);
  Matrix4 flat = identityMatrix();
  flat[1][1] = 0;
  EXPECT_FALSE(builder.addInstance(*id, {flat, flat}));
  TriangleMesh broken;
  broken.positions = {{0, 0, 0}};
  broken.triangles = {{0, 1, 2}};
  EXPECT_FALSE(builder.addShared(std::move(broken)));
}

}  // namespace
}  // namespace aerosol::accel

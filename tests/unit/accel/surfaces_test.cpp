// Surface queries against double-precision brute force over every primitive.

#include <gtest/gtest.h>

#include <xmmintrin.h>
#include <algorithm>
#include <limits>
#include <thread>

#include "core/accel/scene.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {
namespace {

struct Vec {
  long double x = 0, y = 0, z = 0;
};
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
long double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
template <class T>
Vec vec(T p) {
  return {p.x, p.y, p.z};
}

/// What a ray meets by testing every triangle and sphere in long double; `margin` is how far from an edge (in
/// barycentric or relative terms) the nearest decision was, so that undecidable rays can be left out.
struct Reference {
  long double t = std::numeric_limits<long double>::infinity();
  ObjectId object = 0;
  std::uint32_t primitive = 0;
  long double margin = 1;
};

void testTriangle(const TriangleMesh& mesh, ObjectId object, std::uint32_t triangle, const Ray<World>& ray,
                  Reference& best) {
  const auto& i = mesh.triangles[triangle];
  const Vec a = vec(mesh.positions[i[0]]), e1 = vec(mesh.positions[i[1]]) - a, e2 = vec(mesh.positions[i[2]]) - a;
  const Vec n = cross(e1, e2), d = vec(ray.direction), o = vec(ray.origin);
  const long double slope = dot(d, n);
  if (slope == 0) return;
  const long double t = dot(a - o, n) / slope;
  const Vec q{o.x + t * d.x - a.x, o.y + t * d.y - a.y, o.z + t * d.z - a.z};
  const long double u = dot(cross(q, e2), n) / dot(n, n), v = dot(cross(e1, q), n) / dot(n, n);
  const long double inside = std::min({u, v, 1 - u - v});
  if (t > ray.tMin && t < ray.tMax) best.margin = std::min(best.margin, std::abs(inside));
  if (inside < 0 || t <= ray.tMin || t >= ray.tMax || t >= best.t) return;
  best.t = t;
  best.object = object;
  best.primitive = triangle;
}

TriangleMesh randomMesh(Random& random, std::size_t triangles) {
  TriangleMesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const Point<World> centre = random.point(10);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(centre + (random.point(2) - Point<World>()));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

struct Buffers {
  SpanBuffer spans;
  InterfaceBuffer interfaces;
  Counters counters;
};

Scene build(SceneBuilder& builder, const SceneOptions& options = {}) {
  auto scene = builder.build(options);
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

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

TEST(Surfaces, SpheresAndDisksUnderAnyMapAgreeWithTheirEquations) {
  Random random("Surfaces.Spheres");
  for (int k = 0; k < 2'000; ++k) {
    const auto toWorld = randomTransform(random, 5, 1);
    SceneBuilder builder;
    const bool isDisk = k % 2 == 1;
    ASSERT_TRUE(isDisk ? builder.addDisk(toWorld) : builder.addSphere(toWorld));
    const Scene scene = build(builder);
    const Point<Object> target{random.uniformFloat(-0.6, 0.6), random.uniformFloat(-0.6, 0.6), 0};
    const Point<World> from = random.point(20);
    const Ray<World> ray{from, normalize(toWorld(target) - from)};
    Buffers buffers;
    const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters);
    ASSERT_TRUE(hit);
    const Point<Object> p = toWorld.inverse()(hit->point);
    if (isDisk) {
      EXPECT_NEAR(p.z, 0, 1e-5);
      EXPECT_NEAR(hit->u, std::hypot(p.x, p.y), 1e-5);
    } else {
      EXPECT_NEAR(length(p - Point<Object>()), 1, 1e-5);
      EXPECT_NEAR(std::cos(std::numbers::pi * static_cast<double>(hit->v)), p.z, 1e-5);
    }
    EXPECT_NEAR(length(hit->geometricNormal.vector()), 1, 1e-6);
    EXPECT_NEAR(dot(hit->dPdu, hit->geometricNormal), 0, 1e-4);
    EXPECT_NEAR(dot(hit->dPdv, hit->geometricNormal), 0, 1e-4);
    if (!isDisk) {
      // The normal of the image of a sphere points away from its centre's side.
      const Point<World> centre = toWorld(Point<Object>());
      EXPECT_GT(dot(hit->point - centre, hit->geometricNormal), 0);
      const bool startsInside = length(toWorld.inverse()(from) - Point<Object>()) < 1;
      EXPECT_EQ(hit->entering, !startsInside);
    }
  }
}

TEST(Surfaces, CylindersUnderAnyMapAgreeWithTheirEquation) {
  Random random("Surfaces.Cylinders");
  int hits = 0;
  for (int k = 0; k < 2'000; ++k) {
    const auto toWorld = randomTransform(random, 5, 1);
    SceneBuilder builder;
    ASSERT_TRUE(builder.addCylinder(toWorld));
    const Scene scene = build(builder);
    const Point<Object> target{random.uniformFloat(-1.2, 1.2), random.uniformFloat(-1.2, 1.2),
                               random.uniformFloat(-0.3, 1.3)};
    const Point<World> from = random.point(20);
    const Ray<World> ray{from, normalize(toWorld(target) - from)};
    // In the cylinder's space, by the textbook's quadratic.
    const Point<Object> o = toWorld.inverse()(from);
    const Vector<Object> d = toWorld.inverse()(ray.direction);
    const auto at = [](float v) { return static_cast<double>(v); };
    const double a = at(d.x) * at(d.x) + at(d.y) * at(d.y), b = at(o.x) * at(d.x) + at(o.y) * at(d.y);
    const double c = at(o.x) * at(o.x) + at(o.y) * at(o.y) - 1, root = b * b - a * c;
    double first = std::numeric_limits<double>::infinity();
    bool isClose = std::fabs(root) < 1e-3 * b * b;
    for (const double sign : {-1.0, 1.0}) {
      if (root < 0) break;
      const double t = (-b + sign * std::sqrt(root)) / a, z = at(o.z) + t * at(d.z);
      isClose = isClose || std::fabs(z) < 1e-3 || std::fabs(z - 1) < 1e-3 || std::fabs(t) < 1e-3;
      if (t > 0 && z >= 0 && z <= 1) first = std::min(first, t);
    }
    if (isClose) continue;
    Buffers buffers;
    const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters);
    ASSERT_EQ(hit.has_value(), std::isfinite(first)) << k;
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(hit->t, first, 1e-4 * first + 1e-4);
    const Point<Object> p = toWorld.inverse()(hit->point);
    EXPECT_NEAR(std::hypot(p.x, p.y), 1, 2e-5);
    EXPECT_NEAR(hit->v, p.z, 2e-5);
    EXPECT_NEAR(std::cos(2 * std::numbers::pi * at(hit->u)), p.x, 2e-5);
    EXPECT_NEAR(dot(hit->dPdu, hit->geometricNormal), 0, 1e-4);
    EXPECT_NEAR(dot(hit->dPdv, hit->geometricNormal), 0, 1e-4);
    EXPECT_EQ(hit->entering, dot(ray.direction, hit->geometricNormal) < 0);
    // The normal leads away from the axis.
    const Point<World> onAxis = toWorld(Point<Object>{0, 0, p.z});
    EXPECT_GT(dot(hit->point - onAxis, hit->geometricNormal), 0);
  }
  EXPECT_GT(hits, 500);
}

TEST(Surfaces, SmallSphereFarAway) {
  // 1e6 radii away: the textbook discriminant in float, even in double, loses the sphere's shape.
  SceneBuilder builder;
  ASSERT_TRUE(builder.addSphere(translateScale(0, 0, 1e6)));
  const Scene scene = build(builder);
  Buffers buffers;
  for (const float offset : {0.0f, 0.5f, 0.99f, 0.9999f}) {
    const Ray<World> ray{{offset, 0, 0}, {0, 0, 1}};
    const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters);
    ASSERT_TRUE(hit);
    const double b = static_cast<double>(offset);
    EXPECT_NEAR(hit->t, 1e6 - std::sqrt(1 - b * b), 1e-8);
    const HitKey front = hit->key();
    const auto back = scene.closestHit(ray, buffers.spans, buffers.counters, &front);
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->t, 1e6 + std::sqrt(1 - b * b), 1e-8);
  }
  const Ray<World> tangent{{1, 0, 0}, {0, 0, 1}};
  EXPECT_FALSE(scene.closestHit(tangent, buffers.spans, buffers.counters));
}

TEST(Surfaces, CoincidentHitsComeInOrderOfObject) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addMesh(makeRectangle()));
  ASSERT_TRUE(builder.addDisk({}));
  ASSERT_TRUE(builder.addMesh(makeRectangle()));
  const Scene scene = build(builder);
  Random random("Surfaces.Coincident");
  Buffers buffers;
  int exactTies = 0;
  for (int k = 0; k < 1'000; ++k) {
    const Point<World> target{random.uniformFloat(-0.6, 0.6), random.uniformFloat(-0.6, 0.6), 0};
    const Point<World> from = random.point(3);
    const Ray<World> ray{from, normalize(target - from)};
    std::vector<HitKey> keys;
    std::optional<HitKey> after;
    while (const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters, after ? &*after : nullptr)) {
      keys.push_back(hit->key());
      after = hit->key();
    }
    ASSERT_EQ(keys.size(), 3u);
    EXPECT_TRUE(std::ranges::is_sorted(keys));
    for (const HitKey& key : keys) EXPECT_NEAR(key.t, keys[0].t, 1e-12 * keys[0].t);
    if (keys[0].t != keys[2].t) continue;
    ++exactTies;
    for (ObjectId i = 0; i < 3; ++i) EXPECT_EQ(keys[i].object, i);
  }
  EXPECT_GT(exactTies, 100);
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

TEST(Surfaces, OpaqueSurfaceWinsOverCoincidentPassThroughOne) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addMesh(makeCube(translateScale(0, 0, 1)), true));
  ASSERT_TRUE(builder.addMesh(makeRectangle(translateScale(0, 0, 0, 10))));
  const Scene scene = build(builder);
  Buffers buffers;
  const Ray<World> down{{0.25f, 0.5f, 5}, {0, 0, -1}};
  auto hit = scene.closestHit(down, buffers.spans, buffers.counters);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->object, 0u);
  EXPECT_TRUE(hit->passThrough);
  EXPECT_TRUE(hit->entering);
  const HitKey top = hit->key();
  hit = scene.closestHit(down, buffers.spans, buffers.counters, &top);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->object, 1u);
  const Ray<World> up{hit->originTowards({0, 0, 1}), {0, 0, 1}};
  hit = scene.closestHit(up, buffers.spans, buffers.counters);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->object, 0u);
  EXPECT_FALSE(hit->entering);
  EXPECT_NEAR(hit->t, 2, 1e-6);
}

TEST(Surfaces, ShadowRaysCollectPassThroughSurfaces) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addSphere(translateScale(0, 0, 5), true));
  ASSERT_TRUE(builder.addMesh(makeCube(translateScale(0, 0, 5, 2)), true));
  ASSERT_TRUE(builder.addMesh(makeRectangle(translateScale(0, 0, 20))));
  const Scene scene = build(builder);
  Buffers buffers;
  Ray<World> ray{{0.25f, 0.5f, 0}, {0, 0, 1}, 0, 10};
  ASSERT_FALSE(scene.occluded(ray, buffers.spans, buffers.interfaces, buffers.counters));
  ASSERT_EQ(buffers.interfaces.size(), 4u);
  const ObjectId objects[] = {1, 0, 0, 1};
  const bool entering[] = {true, true, false, false};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(buffers.interfaces[i].key.object, objects[i]);
    EXPECT_EQ(buffers.interfaces[i].entering, entering[i]);
  }
  EXPECT_NEAR(buffers.interfaces[0].key.t, 3, 1e-12);
  ray.tMax = 19.5f;
  EXPECT_FALSE(scene.occluded(ray, buffers.spans, buffers.interfaces, buffers.counters));
  ray.tMax = 20;  // A surface exactly at the end does not block.
  EXPECT_FALSE(scene.occluded(ray, buffers.spans, buffers.interfaces, buffers.counters));
  EXPECT_EQ(buffers.interfaces.size(), 4u);
  ray.tMax = std::nextafter(20.0f, 21.0f);
  EXPECT_TRUE(scene.occluded(ray, buffers.spans, buffers.interfaces, buffers.counters));
  EXPECT_TRUE(buffers.interfaces.empty());
}

TEST(Surfaces, RaysThatLeaveASurfaceDoNotMeetItAgain) {
  Random random("Surfaces.Leaving");
  Buffers buffers;
  for (const double place : {0.0, 1.0, 1e3, 1e6}) {
    for (const double size : {1e-3, 1.0, 1e3}) {
      if (size < 1e-5 * place) continue;  // below the resolution of a float
      SceneBuilder builder;
      TriangleMesh mesh = randomMesh(random, 1);
      transformMesh(mesh, translateScale(place, -place, place, size));
      ASSERT_TRUE(builder.addMesh(mesh));
      ASSERT_TRUE(builder.addSphere(translateScale(place, place, -place, size)));
      const Scene scene = build(builder);
      int left = 0;
      for (int k = 0; k < 2'000; ++k) {
        const bool aimsAtSphere = k % 2 == 0;
        const Point<World> corner = mesh.positions[0];
        Point<World> target(static_cast<float>(place), static_cast<float>(place), static_cast<float>(-place));
        if (!aimsAtSphere) {
          const float b1 = random.uniformFloat(0.1, 0.4), b2 = random.uniformFloat(0.1, 0.4);
          target = corner + (mesh.positions[1] - corner) * b1 + (mesh.positions[2] - corner) * b2;
        }
        const Point<World> from = target + random.direction() * static_cast<float>(20 * size);
        const auto hit = scene.closestHit({from, normalize(target - from)}, buffers.spans, buffers.counters);
        if (!hit) continue;
        const Vector<World> direction = random.direction();
        const Ray<World> leaving{hit->originTowards(direction), direction};
        const auto next = scene.closestHit(leaving, buffers.spans, buffers.counters);
        const bool goesInside = hit->object == 1 && dot(direction, hit->geometricNormal) < 0;
        ++left;
        if (!next || next->object != hit->object) {
          // From inside, only the far side may be met; and it must be, unless the direction is all but tangent.
          const double depth = std::fabs(static_cast<double>(dot(direction, hit->geometricNormal)));
          if (goesInside) EXPECT_LT(depth * size, 1e-5 * (place + size)) << place << ' ' << size;
          continue;
        }
        EXPECT_TRUE(goesInside) << place << ' ' << size << " t " << next->t;
      }
      EXPECT_GT(left, 1'000);
    }
  }
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

TEST(Surfaces, RaysThatAreNotFiniteHitNothingAndAreCounted) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addSphere({}));
  const Scene scene = build(builder);
  Buffers buffers;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Ray<World> bad[] = {{{nan, 0, 0}, {0, 0, 1}}, {{0, 0, inf}, {0, 0, 1}},    {{0, 0, 0}, {0, nan, 1}},
                            {{0, 0, 0}, {0, 0, 0}},   {{0, 0, 0}, {0, 0, 1}, nan}, {{0, 0, 0}, {0, 0, 1}, 0, nan}};
  for (const auto& ray : bad) {
    EXPECT_FALSE(scene.closestHit(ray, buffers.spans, buffers.counters));
    EXPECT_FALSE(scene.occluded(ray, buffers.spans, buffers.interfaces, buffers.counters));
  }
  EXPECT_EQ(buffers.counters.invalidRays, 2 * std::size(bad));
  EXPECT_FALSE(scene.closestHit({{0, 0, 0}, {0, 0, 1}, inf, inf}, buffers.spans, buffers.counters));
  EXPECT_FALSE(scene.closestHit({{0, 0, 0}, {0, 0, 1}, 1.5f, 0.5f}, buffers.spans, buffers.counters));
  EXPECT_EQ(buffers.counters.invalidRays, 2 * std::size(bad));
}

TEST(Surfaces, FloatingPointModeIsLeftAlone) {
  const unsigned before = _mm_getcsr() & 0xFFC0u;
  SceneBuilder builder;
  ASSERT_TRUE(builder.addSphere({}));
  const Scene scene = build(builder);
  Buffers buffers;
  EXPECT_TRUE(scene.closestHit({{0, 0, -3}, {0, 0, 1}}, buffers.spans, buffers.counters));
  EXPECT_EQ(_mm_getcsr() & 0xFFC0u, before);
}

TEST(Surfaces, EveryInstructionSetAndThreadGivesTheSameHits) {
  Random random("Surfaces.Isa");
  const TriangleMesh mesh = randomMesh(random, 500);
  std::vector<Ray<World>> rays;
  for (int k = 0; k < 5'000; ++k) rays.push_back({random.point(15), random.direction()});
  const auto trace = [&](const Scene& scene) {
    std::vector<HitKey> keys;
    Buffers buffers;
    for (const auto& ray : rays) {
      const auto hit = scene.closestHit(ray, buffers.spans, buffers.counters);
      keys.push_back(hit ? hit->key() : HitKey{-1});
    }
    return keys;
  };
  std::vector<HitKey> first;
  for (const char* isa : {"sse2", "sse4.2", "avx", "avx2", "avx512", ""}) {
    SceneBuilder builder;
    ASSERT_TRUE(builder.addMesh(mesh));
    auto scene = builder.build({.embreeIsa = isa});
    if (!scene) continue;
    if (*isa) EXPECT_EQ(scene->isa(), isa);
    const auto keys = trace(*scene);
    std::vector<HitKey> other;
    std::thread([&] { other = trace(*scene); }).join();
    EXPECT_EQ(keys, other);
    if (first.empty()) first = keys;
    int different = 0;
    for (std::size_t i = 0; i < keys.size(); ++i) different += keys[i] != first[i];
    EXPECT_EQ(different, 0) << isa;
  }
  ASSERT_FALSE(first.empty());
  SceneBuilder builder;
  const auto unknown = builder.build({.embreeIsa = "mmx"});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.errors().entries()[0].notes.at(0).find("avx2"), std::string::npos);
}

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

}  // namespace
}  // namespace aerosol::accel

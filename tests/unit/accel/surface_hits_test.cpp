// Which of several hits counts, whatever the shapes, the threads and the instruction set.

#include <xmmintrin.h>

#include <thread>

#include "tests/unit/accel/surface_reference.h"

namespace aerosol::accel {
namespace {

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

}  // namespace
}  // namespace aerosol::accel

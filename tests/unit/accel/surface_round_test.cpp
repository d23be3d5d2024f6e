// Queries of spheres, disks and cylinders against their equations.

#include "tests/unit/accel/surface_reference.h"

namespace aerosol::accel {
namespace {

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

}  // namespace
}  // namespace aerosol::accel

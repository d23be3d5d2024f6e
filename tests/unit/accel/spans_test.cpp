// Volume spans against sampling, closed forms and the hard cases of intervals.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/accel/scene.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

Scene build(SceneBuilder& builder) {
  auto scene = builder.build();
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

std::unique_ptr<const VolumeShape> box(const Transform<World, Object>& t) { return std::make_unique<BoxVolume>(t); }
std::unique_ptr<const VolumeShape> ball(const Transform<World, Object>& t) { return std::make_unique<SphereVolume>(t); }

struct Query {
  const Scene& scene;
  SpanBuffer spans;
  InterfaceBuffer interfaces;
  Counters counters;

  explicit Query(const Scene& s) : scene(s) {}
  /// The spans of a ray that meets no surface, by both queries.
  const SpanBuffer& operator()(const Ray<World>& ray) {
    SpanBuffer shadow;
    EXPECT_FALSE(scene.occluded(ray, shadow, interfaces, counters));
    EXPECT_FALSE(scene.closestHit(ray, spans, counters));
    EXPECT_EQ(shadow, spans);
    return spans;
  }
};

/// All spans of a ray in long double, for boxes and balls under general maps.
struct Shape {
  bool isBall = false;
  Transform<World, Object> toWorld;
};

bool referenceSpan(const Shape& shape, const Ray<World>& ray, long double& t0, long double& t1) {
  const Matrix4& m = shape.toWorld.inverseMatrix();
  long double o[3], d[3];
  for (std::size_t i = 0; i < 3; ++i) {
    o[i] = static_cast<long double>(m[i][0]) * ray.origin.x + static_cast<long double>(m[i][1]) * ray.origin.y +
           static_cast<long double>(m[i][2]) * ray.origin.z + m[i][3];
    d[i] = static_cast<long double>(m[i][0]) * ray.direction.x + static_cast<long double>(m[i][1]) * ray.direction.y +
           static_cast<long double>(m[i][2]) * ray.direction.z;
  }
  t0 = static_cast<long double>(ray.tMin);
  t1 = static_cast<long double>(ray.tMax);
  if (shape.isBall) {
    const long double a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
    const long double c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - 1, q = b * b - a * c;
    if (q <= 0) return false;
    t0 = std::max(t0, (-b - std::sqrt(q)) / a);
    t1 = std::min(t1, (-b + std::sqrt(q)) / a);
  } else {
    for (int i = 0; i < 3; ++i) {
      const long double u = (-1 - o[i]) / d[i], v = (1 - o[i]) / d[i];
      t0 = std::max(t0, std::min(u, v));
      t1 = std::min(t1, std::max(u, v));
    }
  }
  return t0 < t1;
}

TEST(Spans, RandomBoxesAndBallsAgreeWithBruteForce) {
  Random random("Spans.Random");
  SceneBuilder builder;
  std::vector<Shape> shapes;
  for (VolumeId i = 0; i < 60; ++i) {
    shapes.push_back({i % 2 == 1, randomTransform(random, 8, random.uniform(0.2, 3))});
    const auto id = builder.addVolume(shapes[i].isBall ? ball(shapes[i].toWorld) : box(shapes[i].toWorld));
    ASSERT_EQ(*id, i);
  }
  const Scene scene = build(builder);
  Query query(scene);
  std::size_t total = 0;
  for (int k = 0; k < 20'000; ++k) {
    Ray<World> ray{random.point(15), random.direction()};
    if (k % 3 == 0) ray.tMin = random.uniformFloat(0, 10);
    if (k % 2 == 0) ray.tMax = ray.tMin + random.uniformFloat(0, 10);
    SpanBuffer expected;
    for (VolumeId i = 0; i < shapes.size(); ++i) {
      long double t0 = 0, t1 = 0;
      if (referenceSpan(shapes[i], ray, t0, t1) && t1 - t0 > 1e-10L) {
        expected.push_back({static_cast<double>(t0), static_cast<double>(t1), i});
      }
    }
    std::ranges::sort(expected);
    SpanBuffer spans = query(ray);
    EXPECT_TRUE(std::ranges::is_sorted(spans, {}, [](const Span& s) { return std::pair(s.t0, s.volume); }));
    std::erase_if(spans, [](const Span& s) { return s.t1 - s.t0 <= 1e-10; });
    ASSERT_EQ(spans.size(), expected.size()) << k;
    std::ranges::sort(spans, {}, &Span::volume);
    std::ranges::sort(expected, {}, &Span::volume);
    for (std::size_t i = 0; i < spans.size(); ++i) {
      EXPECT_EQ(spans[i].volume, expected[i].volume);
      EXPECT_NEAR(spans[i].t0, expected[i].t0, 1e-11 * (1 + expected[i].t0));
      if (std::isfinite(expected[i].t1)) EXPECT_NEAR(spans[i].t1, expected[i].t1, 1e-11 * (1 + expected[i].t1));
    }
    total += spans.size();
  }
  EXPECT_GT(total, 10'000u);
}

TEST(Spans, AreCutAtTheHitAndContinueBehindIt) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(box(translateScale(0, 0, 5, 2))));  // 3 … 7
  ASSERT_TRUE(builder.addVolume(ball(translateScale(0, 0, 9))));    // 8 … 10
  ASSERT_TRUE(builder.addVolume(box(translateScale(0, 0, 4, 4))));  // 0 … 8
  ASSERT_TRUE(builder.addMesh(makeRectangle(translateScale(0, 0, 6)), true));
  const Scene scene = build(builder);
  Query query(scene);
  const Ray<World> ray{{0, 0, 0}, {0, 0, 1}};
  const auto hit = scene.closestHit(ray, query.spans, query.counters);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->t, 6);
  EXPECT_EQ(query.spans, (SpanBuffer{{0, 6, 2}, {3, 6, 0}}));
  const HitKey key = hit->key();
  EXPECT_FALSE(scene.closestHit(ray, query.spans, query.counters, &key));
  EXPECT_EQ(query.spans, (SpanBuffer{{6, 7, 0}, {6, 8, 2}, {8, 10, 1}}));
  EXPECT_FALSE(scene.occluded(ray, query.spans, query.interfaces, query.counters));
  EXPECT_EQ(query.spans, (SpanBuffer{{0, 8, 2}, {3, 7, 0}, {8, 10, 1}}));
}

TEST(Spans, BlockedShadowRayReportsNone) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(ball(translateScale(0, 0, 5))));
  ASSERT_TRUE(builder.addMesh(makeRectangle(translateScale(0, 0, 50))));
  const Scene scene = build(builder);
  Query query(scene);
  EXPECT_TRUE(scene.occluded({{0, 0, 0}, {0, 0, 1}}, query.spans, query.interfaces, query.counters));
  EXPECT_TRUE(query.spans.empty());
}

TEST(Spans, BeginAtTMinInside) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(box({})));
  ASSERT_TRUE(builder.addVolume(ball({})));
  const Scene scene = build(builder);
  Query query(scene);
  EXPECT_EQ(query({{0, 0, 0}, {1, 0, 0}}), (SpanBuffer{{0, 1, 0}, {0, 1, 1}}));
  EXPECT_EQ(query({{0, 0, 0}, {1, 0, 0}, 0.25f, 0.5f}), (SpanBuffer{{0.25, 0.5, 0}, {0.25, 0.5, 1}}));
  EXPECT_TRUE(query({{0, 0, 0}, {1, 0, 0}, 0.5f, 0.5f}).empty());
  EXPECT_TRUE(query({{0, 0, 0}, {1, 0, 0}, infinity, infinity}).empty());
  EXPECT_TRUE(query({{3, 0, 0}, {1, 0, 0}}).empty());
}

TEST(Spans, RayOnOrAlongAFaceIsDefined) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(box({})));                       // x in [-1, 1]
  ASSERT_TRUE(builder.addVolume(box(translateScale(2, 0, 0))));  // x in [1, 3]
  const Scene scene = build(builder);
  Query query(scene);
  // Along the shared face: in exactly one of the two, whatever the sign of zero.
  for (const float zero : {0.0f, -0.0f}) {
    EXPECT_EQ(query({{1, 0, -5}, {zero, zero, 1}}), (SpanBuffer{{4, 6, 1}}));
    EXPECT_EQ(query({{1, 0, 5}, {zero, zero, -1}}), (SpanBuffer{{4, 6, 1}}));
    EXPECT_EQ(query({{-1, 0, -5}, {zero, zero, 1}}), (SpanBuffer{{4, 6, 0}}));
    EXPECT_TRUE(query({{3, 0, -5}, {zero, zero, 1}}).empty());
    // Along edges.
    EXPECT_EQ(query({{-1, -1, -5}, {zero, zero, 1}}), (SpanBuffer{{4, 6, 0}}));
    EXPECT_TRUE(query({{-1, 1, -5}, {zero, zero, 1}}).empty());
    // Through the inside, one component zero.
    EXPECT_EQ(query({{0.5f, 0, -5}, {zero, zero, 1}}), (SpanBuffer{{4, 6, 0}}));
  }
  // Starting on a face, inwards and outwards.
  EXPECT_EQ(query({{0, 0, -1}, {0, 0, 1}}), (SpanBuffer{{0, 2, 0}}));
  EXPECT_TRUE(query({{0, 0, -1}, {0, 0, -1}}).empty());
  EXPECT_EQ(query({{0, 0, 1}, {0, 0, -1}}), (SpanBuffer{{0, 2, 0}}));
  // Across the shared face: no gap and no overlap.
  EXPECT_EQ(query({{-2, 0, 0}, {1, 0, 0}}), (SpanBuffer{{1, 3, 0}, {3, 5, 1}}));
}

TEST(Spans, TangentsMissAndTouchesAreEmpty) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(ball({})));
  const Scene scene = build(builder);
  Query query(scene);
  EXPECT_TRUE(query({{1, 0, -5}, {0, 0, 1}}).empty());
  const float justInside = std::nextafter(1.0f, 0.0f);
  const auto& spans = query({{justInside, 0, -5}, {0, 0, 1}});
  ASSERT_EQ(spans.size(), 1u);
  const double half = std::sqrt(1 - static_cast<double>(justInside) * static_cast<double>(justInside));
  EXPECT_NEAR(spans[0].t1 - spans[0].t0, 2 * half, 1e-9);
}

TEST(Spans, CoplanarFacesKeepBothVolumes) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(box({})));
  ASSERT_TRUE(builder.addVolume(box(translateScale(0, 0, 0, 1, 1, 1))));
  ASSERT_TRUE(builder.addVolume(box(translateScale(0.5, 0, 1, 1, 1, 2))));  // its z range begins at -1 too
  const Scene scene = build(builder);
  Query query(scene);
  EXPECT_EQ(query({{0.25f, 0.25f, -3}, {0, 0, 1}}), (SpanBuffer{{2, 4, 0}, {2, 4, 1}, {2, 6, 2}}));
}

TEST(Spans, FarAwayVolumesKeepTheirThickness) {
  // Camera 1e6 sizes away: in float, t has a spacing of 1/16.
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(ball({})));
  ASSERT_TRUE(builder.addVolume(box(translateScale(0, 0, 0, 0.5))));
  const Scene scene = build(builder);
  Query query(scene);
  const auto& spans = query({{0.25f, 0.25f, -1e6f}, {0, 0, 1}});
  ASSERT_EQ(spans.size(), 2u);
  const double half = std::sqrt(1 - 0.125);
  EXPECT_NEAR(spans[0].t0, 1e6 - half, 1e-9);
  EXPECT_NEAR(spans[0].t1, 1e6 + half, 1e-9);
  EXPECT_NEAR(spans[1].t0, 1e6 - 0.5, 1e-9);
  EXPECT_NEAR(spans[1].t1, 1e6 + 0.5, 1e-9);
}

TEST(Spans, FarFromTheOriginAndAtAnyScale) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double place : {0.0, 1e7}) {
      SceneBuilder builder;
      const double at = place * scale;
      ASSERT_TRUE(builder.addVolume(ball(translateScale(at, at, at, 64 * scale))));
      ASSERT_TRUE(builder.addVolume(box(translateScale(at, at, at, 64 * scale))));
      const Scene scene = build(builder);
      Query query(scene);
      const auto f = static_cast<float>(at);
      const auto back = static_cast<float>(at - 256 * scale);
      const auto& spans = query({{f, f, back}, {0, 0, 1}});
      ASSERT_EQ(spans.size(), 2u) << scale << ' ' << place;
      for (const Span& span : spans) {
        // The float origin is beside the centre line by up to an ulp of its place.
        EXPECT_NEAR(span.t0, at - 64 * scale - static_cast<double>(back), 0.02 * scale);
        EXPECT_NEAR(span.t1 - span.t0, 128 * scale, 0.02 * scale);
      }
    }
  }
}

TEST(Spans, ManyVolumes) {
  SceneBuilder identical, nested, disjoint;
  for (int i = 0; i < 1'000; ++i) {
    ASSERT_TRUE(identical.addVolume(box({})));
    ASSERT_TRUE(nested.addVolume(ball(translateScale(0, 0, 0, 1 + i))));
  }
  for (int i = 0; i < 10'000; ++i) ASSERT_TRUE(disjoint.addVolume(box(translateScale(0, 0, 4.0 * i))));
  const Ray<World> ray{{0.25f, 0.25f, -2'000}, {0, 0, 1}};
  {
    const Scene scene = build(identical);
    Query query(scene);
    const auto& spans = query(ray);
    ASSERT_EQ(spans.size(), 1'000u);
    for (VolumeId i = 0; i < 1'000; ++i) EXPECT_EQ(spans[i], (Span{1'999, 2'001, i}));
  }
  {
    const Scene scene = build(nested);
    Query query(scene);
    const auto& spans = query(ray);
    ASSERT_EQ(spans.size(), 1'000u);
    for (VolumeId i = 0; i < 1'000; ++i) EXPECT_EQ(spans[i].volume, 999 - i);
  }
  {
    const Scene scene = build(disjoint);
    Query query(scene);
    const auto& spans = query(ray);
    ASSERT_EQ(spans.size(), 10'000u);
    for (VolumeId i = 0; i < 10'000; ++i) EXPECT_EQ(spans[i].volume, i);
    // A ray across the row tests the few boxes near it, not all.
    const std::uint64_t before = query.counters.volumeTests;
    EXPECT_EQ(query({{-5, 0, 4'000}, {1, 0, 0}}).size(), 1u);
    EXPECT_LT(query.counters.volumeTests - before, 40u);
  }
}

TEST(Spans, BufferIsReusedWithoutAllocation) {
  SceneBuilder builder;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(builder.addVolume(box(translateScale(0, 0, i))));
  const Scene scene = build(builder);
  Query query(scene);
  query({{0, 0, -5}, {0, 0, 1}});
  const Span* const data = query.spans.data();
  const std::size_t capacity = query.spans.capacity();
  for (int k = 0; k < 100; ++k) query({{0, 0, -5}, {0, 0, 1}});
  EXPECT_EQ(query.spans.data(), data);
  EXPECT_EQ(query.spans.capacity(), capacity);
}

/// Everything below the plane z = 0.
class HalfSpace final : public ConvexVolume {
 public:
  Box<World> worldBounds() const override { return {{-infinity, -infinity, -infinity}, {infinity, infinity, 0}}; }
  std::optional<Interval> intersect(const Ray<World>& ray) const override {
    const double z = static_cast<double>(ray.origin.z), slope = static_cast<double>(ray.direction.z);
    constexpr double everywhere = std::numeric_limits<double>::infinity();
    if (slope == 0) return z < 0 ? std::optional(Interval{-everywhere, everywhere}) : std::nullopt;
    return slope < 0 ? Interval{-z / slope, everywhere} : Interval{-everywhere, -z / slope};
  }
};

TEST(Spans, UnboundedVolumesAreAlwaysThere) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(std::make_unique<HalfSpace>()));
  ASSERT_TRUE(builder.addVolume(ball(translateScale(0, 0, -5))));
  const Scene scene = build(builder);
  EXPECT_EQ(scene.bounds().upper.z, -4);
  EXPECT_EQ(scene.bounds().lower.z, -6);
  Query query(scene);
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  EXPECT_EQ(query({{0, 0, 2}, {0, 0, -1}}), (SpanBuffer{{2, everywhere, 0}, {6, 8, 1}}));
  EXPECT_EQ(query({{9, 0, -2}, {1, 0, 0}}), (SpanBuffer{{0, everywhere, 0}}));
  EXPECT_EQ(query({{9, 0, -2}, {0, 0, 1}, 0, 1}), (SpanBuffer{{0, 1, 0}}));
}

}  // namespace
}  // namespace aerosol::accel

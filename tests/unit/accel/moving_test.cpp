#include "core/accel/moving.h"

#include <gtest/gtest.h>

#include "core/accel/convex_volume.h"
#include "core/accel/scene.h"
#include "core/base/random.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {
namespace {

Matrix4 turned(double degrees, double scale, std::array<double, 3> shift) {
  const double c = std::cos(degrees * 0.017453292519943295), s = std::sin(degrees * 0.017453292519943295);
  Matrix4 m = identityMatrix();
  m[0] = {c * scale, -s, 0, shift[0]};
  m[1] = {s * scale, c, 0, shift[1]};
  m[2] = {0, 0, 1, shift[2]};
  return m;
}

MovingPlacement wild() {
  return MovingPlacement(std::make_shared<const Motion>(std::vector<MotionKey>{{0, turned(0, 1, {0, 0, 0})},
                                                                               {0.3, turned(150, 2, {1, -2, 3})},
                                                                               {0.5, turned(260, 0.5, {4, 1, 0})},
                                                                               {1.2, turned(20, 1, {-3, 2, 1})}}));
}

constexpr Shutter shutter{0, 1};

TEST(SweepBounds, HoldEveryPointAtEveryTime) {
  const Box<World> box{{-1, -0.5f, 0}, {1, 2, 0.25f}};
  const MovingPlacement placement = wild();
  for (const std::size_t segments : {std::size_t{1}, std::size_t{7}, sweepSegments(placement)}) {
    const auto steps = sweepBounds(placement, box, shutter, segments);
    ASSERT_EQ(steps.size(), segments + 1);
    for (int i = 0; i < 20000; ++i) {
      const float time = randomFloat(1, 0, static_cast<std::uint32_t>(i));
      Point<Object> p;
      for (int k = 0; k < 3; ++k) {
        const float u = randomFloat(2 + static_cast<std::uint64_t>(k), 0, static_cast<std::uint32_t>(i));
        p[k] = i % 2 ? (u < 0.5f ? box.lower[k] : box.upper[k]) : box.lower[k] + u * (box.upper[k] - box.lower[k]);
      }
      const Point<World> q = placement.at(time)(p);
      const double at = static_cast<double>(time) * static_cast<double>(segments);
      const auto step = std::min(static_cast<std::size_t>(at), segments - 1);
      const double u = at - static_cast<double>(step);
      for (int k = 0; k < 3; ++k) {
        const double lower =
            (1 - u) * static_cast<double>(steps[step].lower[k]) + u * static_cast<double>(steps[step + 1].lower[k]);
        const double upper =
            (1 - u) * static_cast<double>(steps[step].upper[k]) + u * static_cast<double>(steps[step + 1].upper[k]);
        ASSERT_GE(static_cast<double>(q[k]), lower - 1e-5) << time;
        ASSERT_LE(static_cast<double>(q[k]), upper + 1e-5) << time;
      }
    }
  }
}

/// What moves is hit as its copy that stands where it is at the ray's time.
class AgainstStills : public ::testing::TestWithParam<int> {
 protected:
  template <class Placed>
  static void add(SceneBuilder& builder, int kind, const Placed& placed, bool passThrough) {
    constexpr bool moves = std::is_same_v<Placed, MovingPlacement>;
    const auto meshAt = [&]() -> TriangleMesh {
      if constexpr (moves)
        return makeCube({});
      else
        return makeCube(placed);
    };
    bool isAdded = false;
    if (kind == 0) {
      if constexpr (moves)
        isAdded = static_cast<bool>(builder.addMesh(meshAt(), placed, passThrough));
      else
        isAdded = static_cast<bool>(builder.addMesh(meshAt(), passThrough));
    } else if (kind == 1) {
      isAdded = static_cast<bool>(builder.addSphere(placed, passThrough));
    } else if (kind == 2) {
      isAdded = static_cast<bool>(builder.addDisk(placed, passThrough, true));
    } else {
      Transform<World, Object> rest;
      if constexpr (!moves) rest = placed;
      std::unique_ptr<const VolumeShape> shape;
      if (kind == 3)
        shape = std::make_unique<BoxVolume>(rest);
      else
        shape = std::make_unique<SphereVolume>(rest);
      if constexpr (moves)
        isAdded = static_cast<bool>(builder.addVolume(std::move(shape), placed));
      else
        isAdded = static_cast<bool>(builder.addVolume(std::move(shape)));
    }
    EXPECT_TRUE(isAdded);
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, AgainstStills, ::testing::Range(0, 5));

TEST_P(AgainstStills, HitsSpansAndNormalsAgree) {
  const MovingPlacement placement = wild();
  Counters counters;
  int found = 0;
  for (const bool passThrough : {false, true}) {
    SceneBuilder builder;
    add(builder, GetParam(), placement, passThrough);
    const auto scene = builder.build({.embreeIsa = {}, .shutter = shutter});
    ASSERT_TRUE(scene);
    for (std::uint32_t t = 0; t < 25; ++t) {
      const float time = randomFloat(5, 0, t);
      SceneBuilder stillBuilder;
      add(stillBuilder, GetParam(), placement.at(time), passThrough);
      const auto still = stillBuilder.build();
      ASSERT_TRUE(still);
      for (std::uint32_t i = 0; i < 200; ++i) {
        const auto u = [&](std::uint32_t k) { return randomFloat(77 + k, t, i); };
        Ray<World> ray;
        ray.time = time;
        ray.origin = {12 * u(0) - 6, 12 * u(1) - 6, 12 * u(2) - 6};
        const Point<World> target = placement.at(time)(Point<Object>(2 * u(3) - 1, 2 * u(4) - 1, 2 * u(5) - 1));
        ray.direction = normalize(target - ray.origin);
        SpanBuffer spans, stillSpans;
        InterfaceBuffer interfaces, stillInterfaces;
        const auto hit = scene->closestHit(ray, spans, counters);
        const auto stillHit = still->closestHit(ray, stillSpans, counters);
        ASSERT_EQ(hit.has_value(), stillHit.has_value());
        ASSERT_EQ(spans.size(), stillSpans.size());
        for (std::size_t s = 0; s < spans.size(); ++s) {
          EXPECT_NEAR(spans[s].t0, stillSpans[s].t0, 2e-5);
          EXPECT_NEAR(spans[s].t1, stillSpans[s].t1, 2e-5);
        }
        found += static_cast<int>(spans.size());
        ASSERT_EQ(scene->occluded(ray, spans, interfaces, counters),
                  still->occluded(ray, stillSpans, stillInterfaces, counters));
        ASSERT_EQ(interfaces.size(), stillInterfaces.size());
        if (!hit) continue;
        ++found;
        EXPECT_NEAR(hit->t, stillHit->t, 2e-5);
        EXPECT_EQ(hit->entering, stillHit->entering);
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(hit->point[k], stillHit->point[k], 2e-5);
          EXPECT_NEAR(hit->geometricNormal[k], stillHit->geometricNormal[k], 1e-4);
          EXPECT_NEAR(hit->shadingNormal[k], stillHit->shadingNormal[k], 1e-4);
          EXPECT_NEAR(hit->dPdu[k], stillHit->dPdu[k], 1e-3);
        }
        const HitKey key = hit->key(), stillKey = stillHit->key();
        EXPECT_EQ(scene->closestHit(ray, spans, counters, &key).has_value(),
                  still->closestHit(ray, stillSpans, counters, &stillKey).has_value());
      }
    }
  }
  EXPECT_GT(found, 4000);
}

/// A camera a million sizes away sees the shape as sharply as one nearby.
TEST(MovingVolumes, AreSharpFromAfar) {
  const MovingPlacement placement(std::make_shared<const Motion>(
      std::vector<MotionKey>{{0, turned(0, 1, {0, 0, 0})}, {1, turned(0, 1, {1, 0, 0})}}));
  SceneBuilder builder;
  ASSERT_TRUE(builder.addVolume(std::make_unique<SphereVolume>(Transform<World, Object>()), placement));
  const auto scene = builder.build({.embreeIsa = {}, .shutter = shutter});
  ASSERT_TRUE(scene);
  Ray<World> ray;
  ray.time = 0.5f;
  ray.origin = {0.5f, 0.5f, -1e6f};
  ray.direction = {0, 0, 1};
  SpanBuffer spans;
  Counters counters;
  EXPECT_FALSE(scene->closestHit(ray, spans, counters));
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_NEAR(spans[0].t1 - spans[0].t0, 2 * std::sqrt(0.75), 1e-6);
}

TEST(MovingSurfaces, NeedAnOpenShutter) {
  SceneBuilder builder;
  ASSERT_TRUE(builder.addSphere(wild()));
  EXPECT_FALSE(builder.build());
}

}  // namespace
}  // namespace aerosol::accel

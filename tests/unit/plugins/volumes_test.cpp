// Volume primitives of one interval against their defining inequality in long double.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/accel/convex_volume.h"
#include "core/render/registry.h"
#include "plugins/registration.h"
#include "tests/unit/accel/random.h"

namespace aerosol::render {
namespace {

using Real = long double;

#if defined(__has_feature) && (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
constexpr int placeCount = 5;
#else
constexpr int placeCount = 100;
#endif

/// How far inside a point of object space is, in object units; negative outside.
using Depth = std::function<Real(Real x, Real y, Real z)>;

struct Shape {
  const char* type;
  Depth depth;
};

const std::vector<Shape> shapes = {
    {"sphere", [](Real x, Real y, Real z) { return 1 - std::sqrt(x * x + y * y + z * z); }},
    {"box", [](Real x, Real y, Real z) { return 1 - std::max({std::abs(x), std::abs(y), std::abs(z)}); }},
    {"cylinder", [](Real x, Real y, Real z) { return std::min(1 - std::sqrt(x * x + y * y), 1 - std::abs(z)); }},
    {"cone", [](Real x, Real y, Real z) { return std::min((1 - z) / 2 - std::sqrt(x * x + y * y), 1 - std::abs(z)); }},
};

class Volumes : public testing::TestWithParam<Shape> {
 protected:
  void SetUp() override { registerPlugins(registry_); }

  std::unique_ptr<const accel::VolumeShape> make(const Transform<World, Object>& toWorld) {
    scene::Volume volume;
    volume.type = GetParam().type;
    for (const scene::ParameterSpec& spec : registry_.volume(volume.type)->described.parameters) {
      volume.parameters.push_back({spec.name, *spec.defaultValue});
    }
    auto made = registry_.volume(volume.type)->make({volume, toWorld, {}, warnings_, nullptr});
    EXPECT_TRUE(made);
    return std::move(*made);
  }

  Real depthAt(const Transform<World, Object>& toWorld, const Ray<World>& ray, Real t) const {
    const Matrix4& m = toWorld.inverseMatrix();
    Real p[3];
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = m[i][3];
      for (int j = 0; j < 3; ++j) {
        const Real x = static_cast<Real>(ray.origin[j]) + t * static_cast<Real>(ray.direction[j]);
        p[i] += static_cast<Real>(m[i][static_cast<std::size_t>(j)]) * x;
      }
    }
    return GetParam().depth(p[0], p[1], p[2]);
  }

  /// A convex shape: both ends are on the surface and the middle is inside; a miss is nowhere inside.
  void check(const accel::VolumeShape& volume, const Transform<World, Object>& toWorld, const Ray<World>& ray,
             Real tolerance) {
    accel::IntervalList intervals;
    EXPECT_TRUE(volume.intersect(ray, intervals));
    ASSERT_LE(intervals.size(), 1u);
    if (intervals.empty()) {
      for (int i = 0; i <= 40; ++i) ASSERT_LT(depthAt(toWorld, ray, -10 + i * 0.5L), tolerance);
      return;
    }
    const Real t0 = intervals[0].t0, t1 = intervals[0].t1;
    ASSERT_LT(t0, t1);
    ASSERT_NEAR(static_cast<double>(depthAt(toWorld, ray, t0)), 0, static_cast<double>(tolerance));
    ASSERT_NEAR(static_cast<double>(depthAt(toWorld, ray, t1)), 0, static_cast<double>(tolerance));
    ASSERT_GT(depthAt(toWorld, ray, (t0 + t1) / 2), -tolerance);
    ++hits_;
  }

  Registry registry_;
  Diagnostics warnings_;
  int hits_ = 0;
};

TEST_P(Volumes, agreeWithTheirInequalityOnAMillionRays) {
  accel::Random random(std::string("volumes.") + GetParam().type);
  for (int place = 0; place < placeCount; ++place) {
    const auto toWorld = place == 0 ? Transform<World, Object>() : accel::randomTransform(random, 1, 1);
    const auto volume = make(toWorld);
    for (int k = 0; k < 10'000; ++k) {
      Ray<World> ray{random.point(k % 2 ? 4.0 : 1.0), random.direction()};
      if (k % 10 == 7) {
        ray.direction = {0, 0, 0};
        ray.direction[k % 3] = k % 4 ? 1.0f : -1.0f;
        if (k % 20 == 7) ray.direction[(k + 1) % 3] = -0.0f;
      }
      if (k % 10 == 8) ray.origin = {0, 0, random.uniformFloat(-2, 2)};
      ASSERT_NO_FATAL_FAILURE(check(*volume, toWorld, ray, 1e-9L)) << place << " " << k;
    }
  }
  EXPECT_GT(hits_, 2000 * placeCount);
}

TEST_P(Volumes, boundsHoldAllIntervals) {
  accel::Random random(std::string("volumes.bounds.") + GetParam().type);
  for (int place = 0; place < 50; ++place) {
    const auto toWorld = accel::randomTransform(random, 5, 2);
    const auto volume = make(toWorld);
    const Box<World> bounds = volume->worldBounds();
    for (int k = 0; k < 500; ++k) {
      const Ray<World> ray{bounds.lower + (bounds.upper - bounds.lower) * random.uniformFloat(0, 1),
                           random.direction()};
      accel::IntervalList intervals;
      volume->intersect(ray, intervals);
      for (const accel::Interval& interval : intervals) {
        for (const double t : {interval.t0, interval.t1}) {
          for (int axis = 0; axis < 3; ++axis) {
            const double x = static_cast<double>(ray.origin[axis]) + t * static_cast<double>(ray.direction[axis]);
            EXPECT_GE(x, static_cast<double>(bounds.lower[axis]) - 1e-9);
            EXPECT_LE(x, static_cast<double>(bounds.upper[axis]) + 1e-9);
          }
        }
      }
    }
  }
}

TEST_P(Volumes, losesNoDigitsFromAMillionSizesAway) {
  const auto volume = make({});
  for (const double distance : {1e3, 1e5, 1e6}) {
    accel::IntervalList intervals;
    volume->intersect({{static_cast<float>(-distance), 0, -0.5f}, {1, 0, 0}}, intervals);
    ASSERT_EQ(intervals.size(), 1u);
    accel::IntervalList nearby;
    volume->intersect({{-2, 0, -0.5f}, {1, 0, 0}}, nearby);
    EXPECT_NEAR(intervals[0].t0 - distance, nearby[0].t0 - 2, 1e-9);
    EXPECT_NEAR(intervals[0].t1 - distance, nearby[0].t1 - 2, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Volumes, testing::ValuesIn(shapes),
                         [](const auto& shape) { return std::string(shape.param.type); });

TEST(VolumeTypes, segmentsPlaceTheirEnds) {
  Registry registry;
  registerPlugins(registry);
  for (const char* type : {"cylinder", "cone"}) {
    scene::Volume volume;
    volume.type = type;
    volume.parameters = {
        {"p0", Point<scene::Unplaced>(1, 2, 3)}, {"p1", Point<scene::Unplaced>(1, 2, 7)}, {"radius", 0.5f}};
    const auto toWorld = registry.volume(type)->place(volume);
    EXPECT_EQ(toWorld(Point<Object>(0, 0, -1)), Point<World>(1, 2, 3));
    EXPECT_EQ(toWorld(Point<Object>(0, 0, 1)), Point<World>(1, 2, 7));
    EXPECT_NEAR(length(toWorld(Vector<Object>(1, 0, 0))), 0.5f, 1e-6f);
    volume.parameters[1].value = volume.parameters[0].value;
    Diagnostics warnings;
    EXPECT_FALSE(registry.volume(type)->make({volume, toWorld, {}, warnings, nullptr}));
  }
}

}  // namespace
}  // namespace aerosol::render

#include "core/render/ray_footprint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

// Footprints behind curved surfaces against the difference of neighbouring rays.

namespace aerosol::render {
namespace {

using World3 = Vector<World>;

struct Bent {
  Ray<World> ray;
  accel::SurfaceHit hit;
};

World3 mirrored(World3 d, World3 n) { return d - n * (2 * dot(d, n)); }
/// By the index of what is behind, over that before.
World3 refracted(World3 d, World3 n, float eta) {
  const float c = -dot(d, n), sine = (1 - c * c) / (eta * eta);
  return normalize(d / eta + n * (c / eta - std::sqrt(1 - sine)));
}

/// The ray behind the surface; `eta` 0: mirrored.
std::optional<Bent> bend(const accel::Scene& scene, const Ray<World>& ray, float eta) {
  accel::SpanBuffer spans;
  accel::Counters counters;
  const auto hit = scene.closestHit(ray, spans, counters);
  if (!hit) return {};
  World3 n = hit->shadingNormal.vector();
  if (dot(n, ray.direction) > 0) n = -n;
  Bent bent{ray, *hit};
  bent.ray.origin = hit->point;
  bent.ray.direction = eta > 0 ? refracted(ray.direction, n, eta) : mirrored(ray.direction, n);
  return bent;
}

accel::Scene surfaces(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-0.3, 0.3);
  Matrix4 m = identityMatrix(), inverse;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) m[i][k] += number(random);
  }
  EXPECT_TRUE(invert(m, inverse));
  accel::SceneBuilder builder;
  const Transform<World, Object> place(m, inverse);
  const bool isSphere = random() % 2 == 0;
  EXPECT_TRUE(static_cast<bool>(isSphere ? builder.addSphere(place) : builder.addCylinder(place)));
  auto scene = builder.build();
  return std::move(*scene);
}

TEST(RayFootprint, IsTheDifferenceOfNeighboursBehindCurvedSurfaces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(-1, 1);
  int compared = 0;
  for (int round = 0; round < 400; ++round) {
    const accel::Scene scene = surfaces(random);
    Ray<World> ray;
    ray.origin = {number(random), number(random), -4};
    ray.direction = normalize(World3(0.1f * number(random), 0.1f * number(random), 1));
    const Frame<World> frame(ray.direction);
    const World3 dO = frame.at(number(random), number(random), 0);
    const World3 dD = frame.at(0.2f * number(random), 0.2f * number(random), 0);
    const float eta = round % 2 == 0 ? 0 : 1.4f;
    // Far enough apart for floats, near enough for the first order.
    constexpr float h = 2e-3f;
    const auto beside = [&](float step) {
      Ray<World> moved = ray;
      moved.origin = ray.origin + dO * step;
      moved.direction = normalize(ray.direction + dD * step);
      return bend(scene, moved, eta);
    };
    const auto middle = beside(0), before = beside(-h), after = beside(h);
    if (!middle || !before || !after) continue;
    if (std::fabs(dot(ray.direction, middle->hit.shadingNormal)) < 0.3f) continue;
    const World3 position = (after->hit.point - before->hit.point) / (2 * h);
    const World3 direction = (after->ray.direction - before->ray.direction) / (2 * h);
    if (length(direction) > 0.9f * 1) continue;  // Cut off there.
    const RayFootprint footprint{ray.origin, ray.direction, {dO, dO}, {dD, dD}};
    ClosureSample sample;
    sample.direction = middle->ray.direction;
    sample.isDelta = true;
    sample.radianceScale = eta > 0 ? 1 / (eta * eta) : 1;
    const RayFootprint behind = footprintBehind(footprint, scene, middle->hit, sample, 0, 1e6f);
    EXPECT_LT(length(behind.originChange.x - position), 0.02f * (1 + length(position))) << round;
    EXPECT_LT(length(behind.directionChange.y - direction), 0.02f * (1 + length(direction))) << round;
    ++compared;
  }
  EXPECT_GT(compared, 60);
}

TEST(RayFootprint, IsAsItWasWhereNothingBendsTheRay) {
  std::mt19937 random(6);
  const accel::Scene scene = surfaces(random);
  const RayFootprint before{{0, 0, -4}, {0, 0, 1}, {{1, 0, 0}, {0, 1, 0}}, {{0.1f, 0, 0}, {0, 0.1f, 0}}};
  ClosureSample passing;
  passing.direction = before.direction;
  passing.isDelta = passing.isPassing = true;
  const RayFootprint behind = footprintBehind(before, scene, {}, passing, 0, 1e6f);
  EXPECT_EQ(behind.at({0, 0, 6}).x, World3(2, 0, 0));
  EXPECT_EQ(behind.at({0, 0, 6}).y, World3(0, 2, 0));
}

TEST(RayFootprint, OpensByTheWidthOfALobe) {
  const RayFootprint before{{0, 0, 0}, {0, 0, 1}, {{1, 0, 0}, {0, 1, 0}}, {}};
  for (const float pdf : {0.1f, 1.0f, 1e4f}) {
    const RayFootprint behind = footprintScattered(before, {0, 0, 2}, {1, 0, 0}, pdf, false);
    const float width = lobeShare * std::min(1.0f, 1 / std::sqrt(3.14159265f * pdf));
    EXPECT_NEAR(length(behind.directionChange.x), width, 1e-6f);
    EXPECT_NEAR(length(behind.directionChange.y), width, 1e-6f);
    EXPECT_NEAR(dot(behind.directionChange.x, behind.directionChange.y), 0, 1e-9f);
    EXPECT_NEAR(dot(behind.directionChange.x, behind.direction), 0, 1e-9f);
  }
}

TEST(RayFootprint, IsFiniteAndLimitedWhereRaysGraze) {
  const RayFootprint ray{{0, 0, 0}, {1, 0, 0}, {{0, 1, 0}, {0, 0, 1}}, {{0, 0.1f, 0}, {0, 0, 0.1f}}};
  accel::SurfaceHit hit;
  hit.point = {1e6f, 0, 0};
  for (const float z : {0.0f, 1e-20f, 1e-6f}) {
    hit.geometricNormal = hit.shadingNormal = {z, 0, 1};
    const SurfaceFootprint on = footprintOn(ray, hit, 50);
    EXPECT_LE(length(on.position.x), 50.01f);
    EXPECT_LE(length(on.position.y), 50.01f);
  }
}

}  // namespace
}  // namespace aerosol::render

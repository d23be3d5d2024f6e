#include "core/render/light_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace aerosol::render {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int side = 200;

Transform<World, Object> affine(const Matrix4& m) {
  Matrix4 inverse;
  EXPECT_TRUE(invert(m, inverse));
  return {m, inverse};
}

Transform<World, Object> placed(double scale, double x, double y, double z) {
  return affine({{{scale, 0, 0, x}, {0, scale, 0, y}, {0, 0, scale, z}, {0, 0, 0, 1}}});
}

/// Mean of 1 / pdf over a grid of random numbers: the solid angle of the surface's outside.
double solidAngle(const LightSurface& surface, Point<World> from) {
  double sum = 0;
  const auto centre = [](int i) { return (static_cast<float>(i) + 0.5f) / side; };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const auto s = surface.sample(from, {centre((i * 7 + j) % side), {centre(i), centre(j)}});
      if (s) sum += 1 / static_cast<double>(s->pdf);
    }
  }
  return sum / (side * side);
}

TEST(LightSurface, SphereFillsACone) {
  const auto surface = makeSphereLight(placed(2, 1, 2, 3), false);
  for (const double distance : {2.001, 3.0, 10.0, 1e4}) {
    const double expected = 2 * pi * (1 - std::sqrt(1 - 4 / (distance * distance)));
    const double got = solidAngle(*surface, {1, 2, static_cast<float>(3 - distance)});
    EXPECT_NEAR(got / expected, 1, distance < 2.01 ? 1e-3 : 1e-5) << distance;
  }
  EXPECT_NEAR(surface->area(), 16 * pi, 1e-9);
}

TEST(LightSurface, ATinyDistantSphereKeepsItsDigits) {
  const auto surface = makeSphereLight(placed(1e-4, 0, 0, 1000), false);
  const auto s = surface->sample({0, 0, 0}, {0.5f, {0.3f, 0.7f}});
  ASSERT_TRUE(s);
  EXPECT_NEAR(static_cast<double>(s->pdf) * pi * 1e-14, 1, 1e-6);
  EXPECT_NEAR(s->distance, 1000, 1e-3);
}

TEST(LightSurface, SphereSeenFromWithinEmitsInwardsWhenFlipped) {
  const auto inward = makeSphereLight(placed(2, 0, 0, 0), true), outward = makeSphereLight(placed(2, 0, 0, 0), false);
  EXPECT_NEAR(solidAngle(*inward, {0.5f, 0.2f, -1}) / (4 * pi), 1, 1e-3);
  EXPECT_EQ(solidAngle(*outward, {0.5f, 0.2f, -1}), 0);
}

TEST(LightSurface, DiskOnItsAxis) {
  const auto surface = makeDiskLight(placed(1.5, 0, 0, 1), false);
  for (const double h : {0.05, 1.0, 20.0}) {
    const double expected = 2 * pi * (1 - h / std::sqrt(h * h + 2.25));
    EXPECT_NEAR(solidAngle(*surface, {0, 0, static_cast<float>(1 + h)}) / expected, 1, h < 0.1 ? 1e-2 : 1e-4) << h;
    EXPECT_EQ(solidAngle(*surface, {0, 0, static_cast<float>(1 - h)}), 0);
  }
  EXPECT_NEAR(surface->area(), 2.25 * pi, 1e-12);
}

TEST(LightSurface, RectangleAboveItsCentre) {
  const auto toWorld = affine({{{2, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}});
  const auto surface = makeRectangleLight(toWorld, false);
  const auto flipped = makeRectangleLight(toWorld, true);
  const double h = 0.7, expected = 4 * std::asin(2 * 0.5 / std::sqrt((4 + h * h) * (0.25 + h * h)));
  EXPECT_NEAR(solidAngle(*surface, {0, 0, 0.7f}) / expected, 1, 1e-4);
  EXPECT_NEAR(solidAngle(*flipped, {0, 0, -0.7f}) / expected, 1, 1e-4);
  EXPECT_EQ(solidAngle(*flipped, {0, 0, 0.7f}), 0);
  EXPECT_NEAR(surface->area(), 4, 1e-12);
}

TEST(LightSurface, AMirroredRectangleKeepsTheImageOfItsNormal) {
  const auto surface = makeRectangleLight(affine({{{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}), false);
  EXPECT_GT(solidAngle(*surface, {0, 0, 1}), 0);
  EXPECT_EQ(solidAngle(*surface, {0, 0, -1}), 0);
}

TEST(LightSurface, MeshEqualsTheRectangleThatItIs) {
  const auto toWorld = affine({{{1.5, 0.3, 0, 1}, {0, 0.7, 0.2, -2}, {0.1, 0, 0.9, 3}, {0, 0, 0, 1}}});
  const accel::TriangleMesh mesh = accel::makeRectangle(toWorld);
  const auto surface = makeMeshLight(mesh), rectangle = makeRectangleLight(toWorld, false);
  ASSERT_TRUE(surface);
  EXPECT_NEAR(surface->area() / rectangle->area(), 1, 1e-6);
  const Point<World> from{2, -1, 5};
  EXPECT_NEAR(solidAngle(*surface, from) / solidAngle(*rectangle, from), 1, 3e-3);
}

TEST(LightSurface, TrianglesAreChosenByArea) {
  accel::TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {10, 0, 0}, {13, 0, 0}, {10, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 0, 1}, {3, 4, 5}};
  const auto surface = makeMeshLight(mesh);
  int first = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto s = surface->sample({5, 0, 5}, {(static_cast<float>(i) + 0.5f) / 1000, {0.4f, 0.6f}});
    ASSERT_TRUE(s) << "triangles without area are never chosen";
    first += s->point.x < 5 ? 1 : 0;
  }
  EXPECT_EQ(first, 250);
  mesh.triangles = {{0, 0, 1}};
  EXPECT_EQ(makeMeshLight(mesh), nullptr);
}

TEST(LightSurface, NothingWithoutArea) {
  const Matrix4 flat{{{1, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  EXPECT_EQ(makeRectangleLight({flat, identityMatrix()}, false), nullptr);
  EXPECT_EQ(makeDiskLight({flat, identityMatrix()}, false), nullptr);
  EXPECT_EQ(makeSphereLight({flat, identityMatrix()}, false), nullptr);
}

TEST(LightSurface, AreaOfAnEllipsoid) {
  // A prolate spheroid with axes 1, 1, 2: 2π (1 + 2 asin(e) / e), e = √3 / 2.
  const auto surface = makeSphereLight(affine({{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}}}), false);
  const double e = std::sqrt(3.0) / 2;
  EXPECT_NEAR(surface->area() / (2 * pi * (1 + 2 * std::asin(e) / e)), 1, 1e-4);
}

TEST(LightSurface, NoSampleFromAPointOfTheSurface) {
  const auto disk = makeDiskLight(placed(1, 0, 0, 0), false);
  EXPECT_FALSE(disk->sample({0.2f, 0.3f, 0}, {0, {0.1f, 0.9f}}));
  const auto sphere = makeSphereLight(placed(1, 0, 0, 0), false);
  const auto s = sphere->sample({0, 0, 1}, {0, {0.4f, 0.4f}});
  if (s) EXPECT_TRUE(std::isfinite(s->pdf) && s->pdf > 0);
}

}  // namespace
}  // namespace aerosol::render

#include "core/render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace aerosol::render {
namespace {

struct View {
  scene::Sensor sensor;
  scene::Film film;

  View() {
    sensor.fov = 90.0f;
    film.width = 200;
    film.height = 100;
  }
  Ray<World> ray(float x, float y, std::array<float, 2> lens = {0.5f, 0.5f}) const {
    return Camera(sensor, film).ray({x, y, lens, 0.25f});
  }
};

void expectDirection(const Ray<World>& ray, double x, double y, double z) {
  const double l = std::sqrt(x * x + y * y + z * z);
  EXPECT_NEAR(ray.direction.x, x / l, 1e-6);
  EXPECT_NEAR(ray.direction.y, y / l, 1e-6);
  EXPECT_NEAR(ray.direction.z, z / l, 1e-6);
  EXPECT_NEAR(length(ray.direction), 1, 1e-6);
}

TEST(Camera, CornersOfAPerspective) {
  const View s;
  expectDirection(s.ray(100, 50), 0, 0, 1);
  expectDirection(s.ray(0, 0), 1, 0.5, 1);
  expectDirection(s.ray(200, 0), -1, 0.5, 1);
  expectDirection(s.ray(0, 100), 1, -0.5, 1);
  expectDirection(s.ray(200, 100), -1, -0.5, 1);
  EXPECT_EQ(s.ray(0, 0).origin, Point<World>());
  EXPECT_EQ(s.ray(0, 0).time, 0.25f);
}

TEST(Camera, FieldOfViewAlongEachAxis) {
  View s;
  const auto edges = [&](scene::FovAxis axis) {
    s.sensor.fovAxis = axis;
    const Ray<World> corner = s.ray(0, 0);
    return std::pair{corner.direction.x / corner.direction.z, corner.direction.y / corner.direction.z};
  };
  const auto expect = [&](scene::FovAxis axis, double x, double y) {
    const auto [gotX, gotY] = edges(axis);
    EXPECT_NEAR(gotX, x, 1e-5);
    EXPECT_NEAR(gotY, y, 1e-5);
  };
  expect(scene::FovAxis::x, 1, 0.5);
  expect(scene::FovAxis::y, 2, 1);
  expect(scene::FovAxis::smaller, 2, 1);
  expect(scene::FovAxis::larger, 1, 0.5);
  expect(scene::FovAxis::diagonal, 2 / std::sqrt(5.0), 1 / std::sqrt(5.0));
  std::swap(s.film.width, s.film.height);
  expect(scene::FovAxis::smaller, 1, 2);
  expect(scene::FovAxis::larger, 0.5, 1);
}

TEST(Camera, ClipPlanesAreAtRightAnglesToTheView) {
  View s;
  s.sensor.nearClip = 0.5f;
  s.sensor.farClip = 8;
  for (const float x : {0.0f, 60.0f, 100.0f}) {
    const Ray<World> ray = s.ray(x, 10);
    EXPECT_NEAR(ray.at(ray.tMin).z, 0.5, 1e-6);
    EXPECT_NEAR(ray.at(ray.tMax).z, 8, 1e-5);
  }
}

TEST(Camera, FollowsItsTransform) {
  // Looks along world -x from (5, 6, 7), world z up: camera z → -x, y → z, and x = y × z → z × -x = -y.
  View s;
  const Matrix4 m{{{0, 0, -1, 5}, {-1, 0, 0, 6}, {0, 1, 0, 7}, {0, 0, 0, 1}}};
  Matrix4 inverse;
  ASSERT_TRUE(invert(m, inverse));
  s.sensor.toWorld = {m, inverse};
  expectDirection(s.ray(100, 50), -1, 0, 0);
  expectDirection(s.ray(0, 0), -1, -1, 0.5);
  EXPECT_EQ(s.ray(0, 0).origin, Point<World>(5, 6, 7));
}

TEST(Camera, ACropSeesTheSameRays) {
  View whole, crop;
  crop.film.cropOffsetX = 50;
  crop.film.cropOffsetY = 20;
  crop.film.cropWidth = 30;
  crop.film.cropHeight = 30;
  EXPECT_EQ(whole.ray(60.5f, 31.25f).direction, crop.ray(60.5f, 31.25f).direction);
}

TEST(Camera, ThinLensMeetsOnThePlaneOfFocus) {
  View s;
  s.sensor.type = scene::SensorType::thinlens;
  s.sensor.apertureRadius = 0.3f;
  s.sensor.focusDistance = 4.0f;
  const Camera camera(s.sensor, s.film);
  ASSERT_TRUE(camera.hasLens());
  double largest = 0;
  for (int i = 0; i <= 16; ++i) {
    const std::array<float, 2> lens{static_cast<float>(i) / 17, static_cast<float>(i * 5 % 17) / 17};
    const Ray<World> ray = camera.ray({30, 80, lens, 0});
    largest = std::max(largest, std::hypot(static_cast<double>(ray.origin.x), static_cast<double>(ray.origin.y)));
    EXPECT_EQ(ray.origin.z, 0);
    const Point<World> p = ray.at(4 / ray.direction.z);
    EXPECT_NEAR(p.x, 4 * 0.7, 1e-5);
    EXPECT_NEAR(p.y, -4 * 0.3, 1e-5);
  }
  EXPECT_LE(largest, 0.3 + 1e-7);
  EXPECT_GT(largest, 0.2);
  s.sensor.apertureRadius = 0;
  EXPECT_FALSE(Camera(s.sensor, s.film).hasLens());
}

TEST(Camera, AnOrthographicOneHasParallelRays) {
  View s;
  s.sensor.type = scene::SensorType::orthographic;
  s.sensor.nearClip = 0.5f;
  s.sensor.farClip = 8;
  // Scaled by 3 across and by 2 along the view.
  const Matrix4 m{{{3, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 2, 10}, {0, 0, 0, 1}}};
  Matrix4 inverse;
  ASSERT_TRUE(invert(m, inverse));
  s.sensor.toWorld = {m, inverse};
  EXPECT_FALSE(Camera(s.sensor, s.film).hasLens());
  for (const float x : {0.0f, 50.0f, 200.0f}) {
    const Ray<World> ray = s.ray(x, 25);
    EXPECT_EQ(ray.direction, Vector<World>(0, 0, 1));
    EXPECT_NEAR(ray.origin.x, 3 * (1 - x / 100), 1e-6);
    EXPECT_NEAR(ray.origin.y, 3 * 0.25, 1e-6);
    EXPECT_NEAR(ray.at(ray.tMin).z, 10 + 2 * 0.5, 1e-5);
    EXPECT_NEAR(ray.at(ray.tMax).z, 10 + 2 * 8, 1e-5);
  }
}

TEST(Camera, ThePrincipalPointShiftsTheFilm) {
  View s, shifted;
  shifted.sensor.principalPointX = 0.25f;
  shifted.sensor.principalPointY = -0.5f;
  EXPECT_EQ(shifted.ray(50, 50).direction, s.ray(100, 0).direction);
}

TEST(Camera, ThePlanarDensityOfRaysIsUniformOnTheFilm) {
  // The image plane at z = 1 is spanned linearly by film coordinates.
  const View s;
  for (int i = 0; i <= 10; ++i) {
    const Ray<World> ray = s.ray(static_cast<float>(20 * i), 50);
    EXPECT_NEAR(ray.direction.x / ray.direction.z, 1 - 0.2 * i, 1e-6);
  }
}

}  // namespace
}  // namespace aerosol::render

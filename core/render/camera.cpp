#include "core/render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/warp.h"

namespace aerosol::render {

double horizontalTangent(const scene::FieldOfView& fov, double aspect) {
  const double tangent = std::tan(static_cast<double>(fov.degrees) * (std::numbers::pi / 360));
  const bool isWide = aspect > 1;
  switch (fov.axis) {
    case scene::FovAxis::x:
      return tangent;
    case scene::FovAxis::y:
      return tangent * aspect;
    case scene::FovAxis::diagonal:
      return tangent / std::sqrt(1 + 1 / (aspect * aspect));
    case scene::FovAxis::smaller:
      return isWide ? tangent * aspect : tangent;
    case scene::FovAxis::larger:
      return isWide ? tangent : tangent * aspect;
  }
  return tangent;
}

Camera::Camera(const scene::Sensor& sensor, const scene::Film& film)
    : toWorld_(sensor.toWorld.at(sensor.shutter().open)),
      width_(film.width),
      height_(film.height),
      isOrthographic_(sensor.type == scene::SensorType::orthographic),
      tangentX_(isOrthographic_ ? 1 : horizontalTangent(sensor.fieldOfView(), width_ / height_)),
      tangentY_(tangentX_ * height_ / width_),
      shiftX_(static_cast<double>(sensor.principalPointX) * width_),
      shiftY_(static_cast<double>(sensor.principalPointY) * height_),
      nearClip_(static_cast<double>(sensor.nearClip)),
      farClip_(static_cast<double>(sensor.farClip)),
      apertureRadius_(sensor.type == scene::SensorType::thinlens ? static_cast<double>(sensor.apertureRadius) : 0),
      focusDistance_(static_cast<double>(sensor.focusDistance.value_or(sensor.farClip))) {
  if (auto motion = sensor.toWorld.motionDuring(sensor.shutter())) motion_.emplace(std::move(motion));
}

shading::CameraProjection Camera::projection() const {
  const double depth = farClip_ / (farClip_ - nearClip_), aspect = width_ / height_;
  shading::CameraProjection result;
  const double scale = 1 / tangentX_;
  result.toScreen = {{{-scale, 0, 0, 0}, {0, scale, 0, 0}, {0, 0, depth, -depth * nearClip_}, {0, 0, 1, 0}}};
  if (isOrthographic_) {
    const double perUnit = 1 / (farClip_ - nearClip_);
    result.toScreen[2] = {0, 0, perUnit, -perUnit * nearClip_};
    result.toScreen[3] = {0, 0, 0, 1};
  }
  result.screenToNdc = {{{0.5, 0, 0, 0.5 - shiftX_ / width_},
                         {0, -0.5 * aspect, 0, 0.5 - shiftY_ / height_},
                         {0, 0, 1, 0},
                         {0, 0, 0, 1}}};
  result.width = static_cast<int>(width_);
  result.height = static_cast<int>(height_);
  return result;
}

[[gnu::always_inline]] inline Camera::Unplaced Camera::unplacedRay(const CameraSample& sample) const {
  const double sx = (1 - 2 * (static_cast<double>(sample.x) + shiftX_) / width_) * tangentX_;
  const double sy = (1 - 2 * (static_cast<double>(sample.y) + shiftY_) / height_) * tangentY_;
  Unplaced ray;
  if (isOrthographic_) {
    ray.lens = {sx, sy};
    return ray;
  }
  if (hasLens()) {
    const std::array<double, 2> disk = toConcentricDisk(sample.lens);
    ray.lens = {apertureRadius_ * disk[0], apertureRadius_ * disk[1]};
  }
  ray.direction = {sx - ray.lens[0] / focusDistance_, sy - ray.lens[1] / focusDistance_, 1};
  return ray;
}

Ray<World> Camera::ray(const CameraSample& sample) const {
  const auto [lens, d] = unplacedRay(sample);
  const Matrix4 m = motion_ ? motion_->at(sample.time).matrix() : toWorld_.matrix();
  std::array<double, 3> origin, direction;
  for (std::size_t i = 0; i < 3; ++i) {
    origin[i] = m[i][0] * lens[0] + m[i][1] * lens[1] + m[i][3];
    direction[i] = m[i][0] * d[0] + m[i][1] * d[1] + m[i][2] * d[2];
  }
  const double norm =
      std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  const auto point = [](const std::array<double, 3>& v) {
    return Point<World>{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  };
  Ray<World> ray;
  ray.origin = point(origin);
  ray.direction = {static_cast<float>(direction[0] / norm), static_cast<float>(direction[1] / norm),
                   static_cast<float>(direction[2] / norm)};
  ray.tMin = static_cast<float>(nearClip_ * norm);
  ray.tMax = static_cast<float>(farClip_ * norm);
  ray.time = sample.time;
  return ray;
}

double Camera::startReach(float time) const {
  const Matrix4 m = motion_ ? motion_->at(time).matrix() : toWorld_.matrix();
  double reach = 0;
  for (int corner = 0; corner < 16; ++corner) {
    const auto end = [&](int bit) { return (corner >> bit & 1) != 0 ? 1.0f : 0.0f; };
    const Ray<World> first = ray({.x = end(0) * static_cast<float>(width_),
                                  .y = end(1) * static_cast<float>(height_),
                                  .lens = {end(2), end(3)},
                                  .time = time});
    double square = 0;
    for (int i = 0; i < 3; ++i) {
      const double off = static_cast<double>(first.origin[i]) - m[static_cast<std::size_t>(i)][3];
      square += off * off;
    }
    reach = std::max(reach, std::sqrt(square) + static_cast<double>(first.tMin));
  }
  return reach;
}

RayFootprint Camera::footprint(const CameraSample& sample) const {
  const Ray<World> ray = this->ray(sample);
  const Matrix4 m = motion_ ? motion_->at(sample.time).matrix() : toWorld_.matrix();
  // Across a pixel: in camera space, of the origin or of the direction before it is normalised.
  const double stepX = -2 * tangentX_ / width_, stepY = -2 * tangentY_ / height_;
  const auto column = [&](std::size_t k, double step) {
    return Vector<World>{static_cast<float>(m[0][k] * step), static_cast<float>(m[1][k] * step),
                         static_cast<float>(m[2][k] * step)};
  };
  const PixelChange steps{column(0, stepX), column(1, stepY)};
  RayFootprint footprint{ray.origin, ray.direction, {}, {}};
  if (isOrthographic_) {
    footprint.originChange = steps;
    return footprint;
  }
  const std::array<double, 3> d = unplacedRay(sample).direction;
  Vector<World> whole;
  for (std::size_t k = 0; k < 3; ++k) whole = whole + column(k, d[k]);
  const auto turned = [&](Vector<World> step) {
    return (step - ray.direction * dot(ray.direction, step)) / length(whole);
  };
  footprint.directionChange = {turned(steps.x), turned(steps.y)};
  return footprint;
}

}  // namespace aerosol::render

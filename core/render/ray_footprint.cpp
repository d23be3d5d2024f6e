#include "core/render/ray_footprint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerosol::render {

namespace {

using World3 = Vector<World>;

/// Directions change by no more from pixel to pixel: behind tight curvature a footprint has no meaning.
constexpr float largestTurn = 1;

World3 limited(World3 v, float largest) {
  const float l = length(v);
  if (l <= largest) return v;
  return std::isfinite(l) ? v * (largest / l) : World3();
}
PixelChange limited(const PixelChange& change, float largest) {
  return {limited(change.x, largest), limited(change.y, largest)};
}

/// Without the part along a unit vector.
World3 across(World3 v, World3 unit) { return v - unit * dot(v, unit); }

/// Igehy, equations 10 and 11: from the change across the ray to that on the tangent plane.
World3 onPlane(World3 change, World3 direction, Normal<World> normal) {
  return change - direction * (dot(change, normal) / dot(direction, normal));
}

/// The new direction's change at a boundary that sends the ray from one direction to another, by the normal with which
/// the law of reflection (ratio 1) or refraction (ratio n / n') does so. Igehy, equations 12 to 17.
class Bend {
 public:
  Bend(World3 before, World3 after, float ratio, bool crosses) : before_(before), ratio_(ratio), crosses_(crosses) {
    const World3 n = crosses ? before * ratio - after : after - before;
    const float l = length(n);
    isStraight_ = !(l > 1e-5f);
    if (isStraight_) return;
    normal_ = n / l;
    if (dot(normal_, before) > 0) normal_ = -normal_;
    cosine_ = dot(before, normal_);
    cosineAfter_ = dot(after, normal_);
  }

  bool isStraight() const { return isStraight_; }
  World3 normal() const { return normal_; }

  World3 change(World3 direction, World3 normalChange) const {
    const float cosineChange = dot(direction, normal_) + dot(before_, normalChange);
    if (!crosses_) return direction - (normalChange * cosine_ + normal_ * cosineChange) * 2;
    const float along = ratio_ * cosine_ - cosineAfter_;
    const float alongChange = (ratio_ - ratio_ * ratio_ * cosine_ / cosineAfter_) * cosineChange;
    return direction * ratio_ - (normalChange * along + normal_ * alongChange);
  }

 private:
  World3 before_, normal_;
  float ratio_, cosine_ = 0, cosineAfter_ = 0;
  bool crosses_, isStraight_ = false;
};

/// Opens the footprint by the share of a lobe with a density, to the sides on which its neighbours already are.
void widen(RayFootprint& ray, float pdf) {
  const float width = lobeShare * std::min(1.0f, 1 / std::sqrt(std::numbers::pi_v<float> * std::max(pdf, 1e-12f)));
  const Frame<World> frame(ray.direction);
  World3 x = across(ray.originChange.x, ray.direction);
  x = squaredLength(x) > 0 ? normalize(x) : frame.x;
  World3 y = cross(ray.direction, x);
  if (dot(y, ray.originChange.y) < 0) y = -y;
  ray.directionChange.x = limited(ray.directionChange.x + x * width, largestTurn);
  ray.directionChange.y = limited(ray.directionChange.y + y * width, largestTurn);
}

}  // namespace

PixelChange RayFootprint::at(Point<World> point) const {
  const float t = dot(point - origin, direction);
  return {originChange.x + directionChange.x * t, originChange.y + directionChange.y * t};
}

std::array<float, 2> changeOfUv(const accel::SurfaceHit& hit, Vector<World> step) {
  const auto inner = [](World3 a, World3 b) {
    return static_cast<double>(a.x) * static_cast<double>(b.x) + static_cast<double>(a.y) * static_cast<double>(b.y) +
           static_cast<double>(a.z) * static_cast<double>(b.z);
  };
  const double uu = inner(hit.dPdu, hit.dPdu), uv = inner(hit.dPdu, hit.dPdv), vv = inner(hit.dPdv, hit.dPdv);
  const double determinant = uu * vv - uv * uv;
  if (!(std::fabs(determinant) > 1e-30)) return {};
  const double a = inner(hit.dPdu, step), b = inner(hit.dPdv, step);
  return {static_cast<float>((vv * a - uv * b) / determinant), static_cast<float>((uu * b - uv * a) / determinant)};
}

SurfaceFootprint footprintOn(const RayFootprint& ray, const accel::SurfaceHit& hit, float largest) {
  SurfaceFootprint on;
  const PixelChange wide = ray.at(hit.point);
  on.position = limited(
      {onPlane(wide.x, ray.direction, hit.geometricNormal), onPlane(wide.y, ray.direction, hit.geometricNormal)},
      largest);
  on.direction = ray.directionChange;
  on.uv_x = changeOfUv(hit, on.position.x);
  on.uv_y = changeOfUv(hit, on.position.y);
  return on;
}

shading::VolumeFootprint footprintIn(const RayFootprint& ray, Point<World> point, float largest) {
  const PixelChange wide = ray.at(point);
  const World3 x = limited(across(wide.x, ray.direction), largest);
  const World3 y = limited(across(wide.y, ray.direction), largest);
  const World3 z = ray.direction * std::sqrt(length(x) * length(y));
  shading::VolumeFootprint footprint;
  std::size_t next = 0;
  for (const World3& v : {x, y, z, ray.directionChange.x, ray.directionChange.y})
    for (int i = 0; i < 3; ++i) footprint[next++] = v[i];
  return footprint;
}

RayFootprint footprintBehind(const RayFootprint& ray, const accel::Scene& scene, const accel::SurfaceHit& hit,
                             const ClosureSample& sample, float time, float largest) {
  if (sample.isPassing) return ray;
  const SurfaceFootprint on = footprintOn(ray, hit, largest);
  RayFootprint behind{hit.point, sample.direction, on.position, ray.directionChange};
  const bool crosses = dot(sample.direction, hit.geometricNormal) * dot(ray.direction, hit.geometricNormal) > 0;
  const Bend bend(ray.direction, sample.direction, crosses ? std::sqrt(sample.radianceScale) : 1, crosses);
  // What scatters through a sheet follows no law of refraction.
  const bool isScattered = crosses && !sample.isDelta && sample.radianceScale == 1;
  if (!bend.isStraight() && !isScattered) {
    const bool isTurned = dot(bend.normal(), hit.shadingNormal) < 0;
    const auto changed = [&](World3 direction, World3 step) {
      const World3 turn = scene.normalChange(hit, step, time);
      return limited(across(bend.change(direction, isTurned ? -turn : turn), sample.direction), largestTurn);
    };
    behind.directionChange = {changed(ray.directionChange.x, on.position.x),
                              changed(ray.directionChange.y, on.position.y)};
  }
  if (!sample.isDelta) widen(behind, sample.pdf);
  return behind;
}

RayFootprint footprintScattered(const RayFootprint& ray, Point<World> point, Vector<World> direction, float pdf,
                                bool isDelta) {
  if (isDelta) return ray;
  RayFootprint scattered{point, direction, ray.at(point), {}};
  const Frame<World> frame(direction);
  scattered.directionChange = {frame.x * length(ray.directionChange.x), frame.y * length(ray.directionChange.y)};
  widen(scattered, pdf);
  return scattered;
}

RayFootprint footprintBeside(const RayFootprint& ray, const Ray<World>& other) {
  return {other.origin, other.direction, ray.at(other.origin), {}};
}

}  // namespace aerosol::render

#include "core/accel/moving.h"

#include <algorithm>
#include <array>

namespace aerosol::accel {

namespace {

/// Lower and negated upper ends: of both, less holds more.
using Ends = std::array<double, 6>;

Ends placedBox(const MovingPlacement& placement, const Box<World>& box, float time) {
  const Matrix4 m = placement.at(time).matrix();
  Ends ends;
  for (std::size_t row = 0; row < 3; ++row) {
    double lower = m[row][3], upper = m[row][3];
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = m[row][i] * static_cast<double>(box.lower[static_cast<int>(i)]);
      const double b = m[row][i] * static_cast<double>(box.upper[static_cast<int>(i)]);
      lower += std::min(a, b);
      upper += std::max(a, b);
    }
    ends[row] = lower;
    ends[3 + row] = -upper;
  }
  return ends;
}

bool isFinite(const Box<World>& box) {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(box.lower[i]) || !std::isfinite(box.upper[i])) return false;
  }
  return true;
}

/// Shifts the interval that it is given.
class Shifted final : public IntervalSink {
 public:
  Shifted(IntervalSink& sink, double shift) : sink_(sink), shift_(shift) {}
  void add(const Interval& interval) override { sink_.add({interval.t0 + shift_, interval.t1 + shift_}); }

 private:
  IntervalSink& sink_;
  double shift_;
};

}  // namespace

/// Between two steps the boxes' ends are looked at in `parts` places. How much they lie outside of the line between the
/// steps' ends, and a second difference more for what lies between those places, is taken from both steps.
std::vector<Box<World>> sweepBounds(const MovingPlacement& placement, const Box<World>& atRest, const Shutter& shutter,
                                    std::size_t segments) {
  constexpr std::size_t parts = 16;
  std::vector<Ends> looked(segments * parts + 1);
  for (std::size_t i = 0; i < looked.size(); ++i) {
    looked[i] = placedBox(placement, atRest, shutter.at(static_cast<float>(i) / static_cast<float>(looked.size() - 1)));
  }
  std::vector<Ends> steps(segments + 1);
  for (std::size_t s = 0; s <= segments; ++s) steps[s] = looked[s * parts];
  for (std::size_t s = 0; s < segments; ++s) {
    for (std::size_t k = 0; k < 6; ++k) {
      const double begin = looked[s * parts][k], end = looked[(s + 1) * parts][k];
      double outside = 0, bend = 0;
      for (std::size_t p = 0; p <= parts; ++p) {
        const std::size_t i = s * parts + p;
        const double line = begin + (end - begin) * static_cast<double>(p) / static_cast<double>(parts);
        outside = std::max(outside, line - looked[i][k]);
        if (i > 0 && i + 1 < looked.size())
          bend = std::max(bend, std::fabs(looked[i - 1][k] - 2 * looked[i][k] + looked[i + 1][k]));
      }
      steps[s][k] = std::min(steps[s][k], begin - outside - bend);
      steps[s + 1][k] = std::min(steps[s + 1][k], end - outside - bend);
    }
  }
  std::vector<Box<World>> boxes;
  for (const Ends& e : steps) {
    boxes.push_back({{floatBelow(e[0]), floatBelow(e[1]), floatBelow(e[2])},
                     {floatAbove(-e[3]), floatAbove(-e[4]), floatAbove(-e[5])}});
  }
  return boxes;
}

std::size_t sweepSegments(const MovingPlacement& placement) {
  constexpr std::size_t most = 128;  // Embree: RTC_MAX_TIME_STEP_COUNT is 129.
  return std::clamp<std::size_t>(4 * placement.motion().keys().size(), 8, most);
}

SurfaceHit placeHit(const SurfaceHit& hit, const MeshSurface* mesh, const Transform<World, Object>& placement) {
  const Matrix4 &forward = placement.matrix(), &inverse = placement.inverseMatrix();
  SurfaceHit placed = hit;
  const Double3 point = mesh ? pointOn(mesh->mesh, hit) : toDouble(hit.point);
  placed.point = toFloat<Point<World>>(mapPoint(forward, point));
  const Double3 geometric = normalize(mapNormal(inverse, toDouble(hit.geometricNormal)));
  Double3 shading = normalize(mapNormal(inverse, toDouble(hit.shadingNormal)));
  // A map that squeezes may turn them apart by more than a right angle.
  if (dot(shading, geometric) < 0) shading = -shading;
  placed.geometricNormal = toFloat<Normal<World>>(geometric);
  placed.shadingNormal = toFloat<Normal<World>>(shading);
  placed.dPdu = toFloat<Vector<World>>(mapVector(forward, toDouble(hit.dPdu)));
  placed.dPdv = toFloat<Vector<World>>(mapVector(forward, toDouble(hit.dPdv)));
  return placed;
}

double nearestDistance(const DoubleRay& ray, const Box<World>& box) {
  const Double3 middle = (toDouble(box.lower) + toDouble(box.upper)) * 0.5;
  const double t = dot(middle - ray.origin, ray.direction) / dot(ray.direction, ray.direction);
  return std::isfinite(t) ? t : 0;
}

MovingVolume::MovingVolume(std::unique_ptr<const VolumeShape> atRest, MovingPlacement placement, const Shutter& shutter,
                           std::size_t segments)
    : atRest_(std::move(atRest)), placement_(std::move(placement)), restBounds_(atRest_->worldBounds()) {
  if (restBounds_.isEmpty()) return;
  if (!isFinite(restBounds_)) {
    bounds_ = restBounds_;
    return;
  }
  steps_ = sweepBounds(placement_, restBounds_, shutter, segments);
  for (const Box<World>& step : steps_) {
    bounds_.extend(step.lower);
    bounds_.extend(step.upper);
  }
}

/// The shape takes a ray in float: it is given one that starts near to the shape, whose numbers are as fine as the
/// shape's own.
bool MovingVolume::intersect(const Ray<World>& ray, IntervalSink& intervals) const {
  const DoubleRay back = takeBack(placement_.at(ray.time), {toDouble(ray.origin), toDouble(ray.direction)});
  const double shift = isFinite(restBounds_) ? nearestDistance(back, restBounds_) : 0;
  Ray<World> near = ray;
  near.origin = toFloat<Point<World>>(back.origin + back.direction * shift);
  near.direction = toFloat<Vector<World>>(back.direction);
  Shifted shifted(intervals, shift);
  return atRest_->intersect(near, shifted);
}

}  // namespace aerosol::accel

#include "core/accel/curve_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/accel/volume_partition.h"

namespace aerosol::accel {

namespace {

/// The axis and the radius at one place of a segment, with what they change by.
struct Axis {
  Double3 centre, tangent, bend;
  double radius = 0, slope = 0;
};

Axis axisAt(const CurveSet& curves, std::uint32_t segment, double s) {
  const CurvePoint* const p = curves.points.data() + curves.segments[segment];
  std::array<double, 4> value{}, first{}, second{};
  if (curves.basis == CurveBasis::linear) {
    value = {1 - s, s, 0, 0};
    first = {-1, 1, 0, 0};
  } else {
    const double r = 1 - s;
    value = {r * r * r / 6, (3 * s * s * s - 6 * s * s + 4) / 6, (3 * r * r * r - 6 * r * r + 4) / 6, s * s * s / 6};
    first = {-r * r / 2, (3 * s * s - 4 * s) / 2, (-3 * r * r + 4 * r) / 2, s * s / 2};
    second = {r, 3 * s - 2, 3 * r - 2, s};
  }
  Axis axis;
  for (std::size_t i = 0; i < curves.pointsOfSegment(); ++i) {
    const Double3 place = toDouble(p[i].position);
    const auto radius = static_cast<double>(p[i].radius);
    axis.centre = axis.centre + place * value[i];
    axis.tangent = axis.tangent + place * first[i];
    axis.bend = axis.bend + place * second[i];
    axis.radius += radius * value[i];
    axis.slope += radius * first[i];
  }
  return axis;
}

/// Zero where a point of the surface belongs to the place: where a circle around the axis is swept it lies in the plane
/// across; a cone is the envelope of balls.
double mismatch(const CurveSet& curves, const Axis& axis, Double3 point) {
  const double ahead = dot(point - axis.centre, axis.tangent);
  return curves.basis == CurveBasis::linear ? ahead + axis.radius * axis.slope : ahead;
}

/// The place along a segment to which a point of its surface belongs. The mismatch is looked at between evenly spaced
/// places, each of its zeros is found by halving, and that counts whose radius fits the best.
double placeOf(const CurveSet& curves, std::uint32_t segment, Double3 point) {
  constexpr int parts = 8, halvings = 40;
  double best = 0, least = std::numeric_limits<double>::infinity();
  const auto consider = [&](double s) {
    const Axis axis = axisAt(curves, segment, s);
    const double off = std::fabs(length(point - axis.centre) - axis.radius);
    if (off < least) {
      least = off;
      best = s;
    }
  };
  consider(0);
  consider(1);
  double low = mismatch(curves, axisAt(curves, segment, 0), point);
  for (int i = 0; i < parts; ++i) {
    double from = static_cast<double>(i) / parts, to = static_cast<double>(i + 1) / parts;
    const double high = mismatch(curves, axisAt(curves, segment, to), point);
    if ((low > 0) != (high > 0)) {
      const bool falls = low > 0;
      for (int k = 0; k < halvings; ++k) {
        const double middle = (from + to) / 2;
        ((mismatch(curves, axisAt(curves, segment, middle), point) > 0) == falls ? from : to) = middle;
      }
      consider((from + to) / 2);
    }
    low = high;
  }
  return best;
}

struct Foot {
  double s = 0;
  Axis axis;
  Double3 outward;  ///< Unit, from the axis.
  Double3 normal;   ///< Unit.
};

Foot footOf(const CurveSurface& surface, std::uint32_t segment, const DoubleRay& ray, double t) {
  const Double3 point = ray.origin + ray.direction * t;
  Foot foot;
  foot.s = placeOf(surface.curves, segment, point);
  foot.axis = axisAt(surface.curves, segment, foot.s);
  const Axis& axis = foot.axis;
  Double3 away = point - axis.centre;
  if (surface.curves.basis == CurveBasis::bSpline) {
    const double squared = dot(axis.tangent, axis.tangent);
    if (squared > 0) away = away - axis.tangent * (dot(away, axis.tangent) / squared);
  }
  foot.outward = normalize(away);
  foot.normal = foot.outward;
  if (surface.curves.basis == CurveBasis::bSpline) {
    // Across both dP/ds = c' + r' n - r (n c'') c' / |c'|^2 and the way around.
    const Double3 reach = foot.outward * axis.radius;
    const Double3 n =
        reach * (dot(axis.tangent, axis.tangent) - dot(reach, axis.bend)) - axis.tangent * (axis.slope * axis.radius);
    const Double3 unit = normalize(n);
    if (dot(unit, foot.outward) > 0) foot.normal = unit;
  }
  return foot;
}

/// Unit, across the tangent, the same for the same tangent; and the way around from there.
std::array<Double3, 2> framesOf(Double3 tangent) {
  const Double3 along = normalize(tangent);
  const Double3 guide = std::fabs(along.z) < 0.999999 ? Double3{0, 0, 1} : Double3{0, 1, 0};
  const Double3 side = normalize(guide - along * dot(along, guide));
  return {cross(side, along), side};
}

}  // namespace

Box<World> CurveSurface::worldBounds() const {
  Box<World> box;
  for (const CurvePoint& p : curves.points) {
    const Vector<World> reach(p.radius, p.radius, p.radius);
    box.extend(p.position - reach);
    box.extend(p.position + reach);
  }
  return withMargin(box);
}

bool isOwnStart(const CurveSurface& surface, std::uint32_t segment, const DoubleRay& ray, double t) {
  const CurvePoint* const p = surface.curves.points.data() + surface.curves.segments[segment];
  float radius = 0;
  for (std::size_t i = 0; i < surface.curves.pointsOfSegment(); ++i) radius = std::max(radius, p[i].radius);
  return t * length(ray.direction) < static_cast<double>(radius) * 0x1p-7;
}

SurfaceHit describeHit(const CurveSurface& surface, std::uint32_t segment, const DoubleRay& ray, double t) {
  const Foot foot = footOf(surface, segment, ray, t);
  const Axis& axis = foot.axis;
  const auto [around, side] = framesOf(axis.tangent);
  const auto& along = surface.curves.along[segment];
  const double from = static_cast<double>(along[0]), stretch = static_cast<double>(along[1]) - from;
  SurfaceHit hit;
  hit.t = t;
  hit.object = surface.object;
  hit.primitive = segment;
  hit.passThrough = surface.passThrough;
  hit.entering = true;
  hit.point = toFloat<Point<World>>(axis.centre + foot.outward * axis.radius);
  hit.geometricNormal = hit.shadingNormal = toFloat<Normal<World>>(foot.normal);
  const double angle = std::atan2(dot(foot.outward, side), dot(foot.outward, around)) / (2 * std::numbers::pi);
  hit.u = static_cast<float>(angle < 0 ? angle + 1 : angle);
  hit.v = static_cast<float>(from + foot.s * stretch);
  hit.dPdu =
      toFloat<Vector<World>>(cross(normalize(axis.tangent), foot.outward) * (2 * std::numbers::pi * axis.radius));
  hit.dPdv = toFloat<Vector<World>>((axis.tangent + foot.outward * axis.slope) * (1 / stretch));
  return hit;
}

}  // namespace aerosol::accel

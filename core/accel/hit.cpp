#include "core/accel/hit.h"

#include "core/accel/double3.h"

namespace aerosol::accel {

namespace {

double ulp(float x) {
  const float magnitude = std::fabs(x);
  const float next = std::nextafter(magnitude, std::numeric_limits<float>::infinity());
  return static_cast<double>(next) - static_cast<double>(magnitude);
}

}  // namespace

// A hit point is computed in double and rounded to float, so it is off by at most e_i = ulp(p_i)/2 per coordinate, and
// off its plane by at most e·|n|. Moving it by 2 e·|n| along n and rounding every coordinate away from the plane
// therefore ends strictly on the wanted side. Same idea as Wächter and Binder, "A Fast and Robust Method for Avoiding
// Self-Intersection" (Ray Tracing Gems, 2019) and the error bounds of pbrt; less than they need, because
// intersections here are decided in double.
Point<World> offsetPoint(Point<World> p, Normal<World> geometricNormal, Vector<World> direction) {
  const Double3 n = toDouble(geometricNormal);
  const double side = dot(toDouble(direction), n) >= 0 ? 1 : -1;
  const double distance = std::fabs(n.x) * ulp(p.x) + std::fabs(n.y) * ulp(p.y) + std::fabs(n.z) * ulp(p.z);
  const Double3 moved = toDouble(p) + n * (side * distance);
  const auto away = [&](double to, double component) {
    if (component == 0) return static_cast<float>(to);
    return component * side > 0 ? floatAbove(to) : floatBelow(to);
  };
  return {away(moved.x, n.x), away(moved.y, n.y), away(moved.z, n.z)};
}

Point<World> SurfaceHit::originTowards(Vector<World> direction) const {
  return offsetPoint(point, geometricNormal, direction);
}

Point<World> pointAt(const Ray<World>& ray, double t) {
  return toFloat<Point<World>>(toDouble(ray.origin) + toDouble(ray.direction) * t);
}

}  // namespace aerosol::accel

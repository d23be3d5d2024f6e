#include "core/render/light_cone.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aerosol::render {

namespace {

using Double3 = std::array<double, 3>;

constexpr double infinity = std::numeric_limits<double>::infinity();

double dot(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Double3 cross(const Double3& a, const Double3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

LightCone coneAlongZ(const Matrix4& toWorld, double tangent) {
  std::array<Double3, 3> columns;
  for (std::size_t j = 0; j < 3; ++j) columns[j] = {toWorld[0][j], toWorld[1][j], toWorld[2][j]};
  const double squared = dot(columns[2], columns[2]);
  constexpr double tolerance = 1e-5;
  bool keepsAngles = squared > 0 && std::isfinite(squared);
  for (std::size_t j = 0; j < 3; ++j) {
    const double length = dot(columns[j], columns[j]), skew = dot(columns[j], columns[(j + 1) % 3]);
    keepsAngles =
        keepsAngles && std::fabs(length - squared) <= tolerance * squared && std::fabs(skew) <= tolerance * squared;
  }
  if (!keepsAngles) return {};
  const double size = std::sqrt(squared);
  return {{columns[2][0] / size, columns[2][1] / size, columns[2][2] / size}, tangent};
}

// Of a point v from the tip, inside: v·A ≥ 0 and (tan v·A)² ≥ |v × A|². On the line v = w + s d, with s counted from
// where it is nearest to the tip, the difference of both sides is a s² + 2 b s + c. Cross products keep the digits of
// narrow cones.
ConeStretch insideCone(const LightCone& cone, const Double3& toApex, const Double3& along) {
  if (cone.isWhole()) return {-infinity, infinity};
  const double nearest = dot(toApex, along);
  Double3 w;
  for (std::size_t i = 0; i < 3; ++i) w[i] = nearest * along[i] - toApex[i];
  const double h = dot(w, cone.axis), m = dot(along, cone.axis), t2 = cone.tangent * cone.tangent;
  const Double3 p = cross(w, cone.axis), q = cross(along, cone.axis);
  const double a = t2 * m * m - dot(q, q), b = t2 * h * m - dot(p, q), c = t2 * h * h - dot(p, p);
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0)) return {};
  const double root = b < 0 ? std::sqrt(discriminant) - b : -(b + std::sqrt(discriminant));
  if (root == 0) {
    // Through the tip, and nowhere else inside but along its own direction.
    if (a <= 0) return {};
    return m > 0 ? ConeStretch{nearest, infinity} : ConeStretch{-infinity, nearest};
  }
  double first = a != 0 ? root / a : std::copysign(infinity, root), second = c / root;
  if (first > second) std::swap(first, second);
  if (a < 0) {
    const bool isAhead = h + 0.5 * (first + second) * m >= 0;
    return isAhead ? ConeStretch{nearest + first, nearest + second} : ConeStretch{};
  }
  // Outside of both roots; one side is the cone, the other one its mirror image.
  if (m > 0) return {nearest + second, infinity};
  return {-infinity, nearest + first};
}

}  // namespace aerosol::render

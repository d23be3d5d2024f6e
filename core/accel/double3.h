// Double precision triples and affine maps, for intersections far from the origin.
#pragma once

#include <cmath>

#include "core/base/geometry.h"

namespace aerosol::accel {

/// A bare triple of doubles. Does not leave the code of an intersection.
struct Double3 {
  double x = 0, y = 0, z = 0;

  friend constexpr Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Double3 operator-(Double3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Double3 operator*(Double3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
};

constexpr double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Double3 cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Double3 a) { return std::sqrt(dot(a, a)); }
/// Unit length; a zero vector stays zero.
inline Double3 normalize(Double3 a) {
  const double l = length(a);
  return l > 0 ? a * (1 / l) : a;
}

template <class Triple>
constexpr Double3 toDouble(const Triple& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
/// `Triple` is a Point, Vector or Normal.
template <class Triple>
constexpr Triple toFloat(Double3 p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

inline Double3 mapPoint(const Matrix4& m, Double3 p) {
  const auto row = [&](std::size_t i) { return m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3]; };
  return {row(0), row(1), row(2)};
}
inline Double3 mapVector(const Matrix4& m, Double3 v) {
  const auto row = [&](std::size_t i) { return m[i][0] * v.x + m[i][1] * v.y + m[i][2] * v.z; };
  return {row(0), row(1), row(2)};
}
/// A normal through a map whose inverse is `inverse`; not renormalised.
inline Double3 mapNormal(const Matrix4& inverse, Double3 n) {
  const auto column = [&](std::size_t i) { return inverse[0][i] * n.x + inverse[1][i] * n.y + inverse[2][i] * n.z; };
  return {column(0), column(1), column(2)};
}

/// The determinant of the upper left 3x3 block; negative for a mirror.
inline double linearDeterminant(const Matrix4& m) {
  return dot({m[0][0], m[0][1], m[0][2]}, cross({m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}));
}

/// The nearest float not above `x` / not below `x`.
inline float floatBelow(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
inline float floatAbove(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

/// The smallest float box around `centre` ± `extent`.
inline Box<World> outwardBox(Double3 centre, Double3 extent) {
  const Double3 lower = centre - extent, upper = centre + extent;
  return {{floatBelow(lower.x), floatBelow(lower.y), floatBelow(lower.z)},
          {floatAbove(upper.x), floatAbove(upper.y), floatAbove(upper.z)}};
}

}  // namespace aerosol::accel

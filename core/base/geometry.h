// Points, vectors, normals and transforms that carry their space in their type.
#pragma once

#include <array>
#include <cmath>
#include <limits>

namespace aerosol {

struct World {};   ///< Space of the scene.
struct Object {};  ///< Space of one primitive.
struct Camera {};  ///< Looks along +z, +y up, as Mitsuba has it.

namespace detail {

/// Three floats of one kind (Kind) in one space.
template <class Derived>
struct Triple {
  float x = 0, y = 0, z = 0;

  constexpr Triple() = default;
  constexpr Triple(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
  constexpr float& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr float operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  friend constexpr bool operator==(const Derived& a, const Derived& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

}  // namespace detail

/// A displacement or a direction in `Space`.
template <class Space>
struct Vector : detail::Triple<Vector<Space>> {
  using detail::Triple<Vector<Space>>::Triple;

  friend constexpr Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vector operator-(Vector a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vector operator*(Vector a, float s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vector operator*(float s, Vector a) { return a * s; }
  friend constexpr Vector operator/(Vector a, float s) { return {a.x / s, a.y / s, a.z / s}; }
};

/// A surface normal in `Space`; transforms by the inverse transpose.
template <class Space>
struct Normal : detail::Triple<Normal<Space>> {
  using detail::Triple<Normal<Space>>::Triple;
  constexpr explicit Normal(Vector<Space> v) : detail::Triple<Normal<Space>>(v.x, v.y, v.z) {}
  constexpr Vector<Space> vector() const { return {this->x, this->y, this->z}; }
  friend constexpr Normal operator-(Normal a) { return {-a.x, -a.y, -a.z}; }
};

/// A position in `Space`.
template <class Space>
struct Point : detail::Triple<Point<Space>> {
  using detail::Triple<Point<Space>>::Triple;

  friend constexpr Point operator+(Point p, Vector<Space> v) { return {p.x + v.x, p.y + v.y, p.z + v.z}; }
  friend constexpr Point operator-(Point p, Vector<Space> v) { return {p.x - v.x, p.y - v.y, p.z - v.z}; }
  friend constexpr Vector<Space> operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};

template <class S>
constexpr float dot(Vector<S> a, Vector<S> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
constexpr float dot(Vector<S> a, Normal<S> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
constexpr Vector<S> cross(Vector<S> a, Vector<S> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
constexpr float squaredLength(Vector<S> v) {
  return dot(v, v);
}
template <class S>
inline float length(Vector<S> v) {
  return std::sqrt(dot(v, v));
}
/// Unit length; a zero vector stays zero.
template <class S>
inline Vector<S> normalize(Vector<S> v) {
  const float l = length(v);
  return l > 0 ? v / l : v;
}
template <class S>
inline Normal<S> normalize(Normal<S> n) {
  return Normal<S>(normalize(n.vector()));
}

/// A right-handed orthonormal frame whose z axis is a given unit vector (Duff et al. 2017, "Building an Orthonormal
/// Basis, Revisited").
template <class Space>
struct Frame {
  Vector<Space> x, y, z;

  explicit Frame(Vector<Space> unitZ) : z(unitZ) {
    const float sign = std::copysign(1.0f, unitZ.z);
    const float a = -1.0f / (sign + unitZ.z);
    const float b = unitZ.x * unitZ.y * a;
    x = {1.0f + sign * unitZ.x * unitZ.x * a, sign * b, -sign * unitZ.x};
    y = {b, sign + unitZ.y * unitZ.y * a, -unitZ.y};
  }
  /// The vector with components (a, b, c) along (x, y, z).
  Vector<Space> at(float a, float b, float c) const { return x * a + y * b + z * c; }
};

/// A ray: `origin + t * direction`, t in [tMin, tMax]. `direction` is of unit length in world space.
template <class Space>
struct Ray {
  Point<Space> origin;
  Vector<Space> direction;
  float tMin = 0;
  float tMax = std::numeric_limits<float>::infinity();
  float time = 0;  ///< Seconds of the scene's time, while the shutter is open.

  constexpr Point<Space> at(float t) const { return origin + direction * t; }
};

/// An axis-aligned box; empty when lower > upper.
template <class Space>
struct Box {
  Point<Space> lower{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                     std::numeric_limits<float>::infinity()};
  Point<Space> upper{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                     -std::numeric_limits<float>::infinity()};

  constexpr bool isEmpty() const { return lower.x > upper.x || lower.y > upper.y || lower.z > upper.z; }
  constexpr void extend(Point<Space> p) {
    for (int i = 0; i < 3; ++i) {
      if (p[i] < lower[i]) lower[i] = p[i];
      if (p[i] > upper[i]) upper[i] = p[i];
    }
  }
};

using Matrix4 = std::array<std::array<double, 4>, 4>;  ///< Row-major, for column vectors: p' = M p.

/// Product of two 4x4 matrices.
Matrix4 multiply(const Matrix4& a, const Matrix4& b);
/// Inverse by Gauss–Jordan elimination with pivoting in double; false when singular.
bool invert(const Matrix4& matrix, Matrix4& inverse);
Matrix4 identityMatrix();

/// The only bridge between spaces: an affine map with its inverse.
template <class To, class From>
class Transform {
 public:
  Transform() : forward_(identityMatrix()), inverse_(identityMatrix()) {}
  /// `inverse` must be the inverse of `forward`.
  Transform(const Matrix4& forward, const Matrix4& inverse) : forward_(forward), inverse_(inverse) {}

  Point<To> operator()(Point<From> p) const {
    const auto row = [&](int i) {
      const auto& m = forward_[static_cast<std::size_t>(i)];
      return static_cast<float>(m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3]);
    };
    return {row(0), row(1), row(2)};
  }
  Vector<To> operator()(Vector<From> v) const {
    const auto row = [&](int i) {
      const auto& m = forward_[static_cast<std::size_t>(i)];
      return static_cast<float>(m[0] * v.x + m[1] * v.y + m[2] * v.z);
    };
    return {row(0), row(1), row(2)};
  }
  /// Not renormalised.
  Normal<To> operator()(Normal<From> n) const {
    const auto column = [&](std::size_t i) {
      return static_cast<float>(inverse_[0][i] * n.x + inverse_[1][i] * n.y + inverse_[2][i] * n.z);
    };
    return {column(0), column(1), column(2)};
  }

  Transform<From, To> inverse() const { return {inverse_, forward_}; }
  const Matrix4& matrix() const { return forward_; }
  const Matrix4& inverseMatrix() const { return inverse_; }

 private:
  Matrix4 forward_, inverse_;
};

/// First scales by `radius` (not 0) about the origin, moves to `center`, then applies `outer`.
template <class To, class From>
Transform<To, From> ballPlacement(const Transform<To, From>& outer, Point<From> center, float radius) {
  Matrix4 place = identityMatrix();
  Matrix4 inverse = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    place[i][i] = static_cast<double>(radius);
    place[i][3] = static_cast<double>(center[static_cast<int>(i)]);
    inverse[i][i] = 1 / place[i][i];
    inverse[i][3] = -place[i][3] / place[i][i];
  }
  return {multiply(outer.matrix(), place), multiply(inverse, outer.inverseMatrix())};
}

}  // namespace aerosol

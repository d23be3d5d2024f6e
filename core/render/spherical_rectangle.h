// A rectangle seen from a point, sampled uniformly by solid angle.
//
// Ureña, Fajardo and King 2013, "An Area-Preserving Parametrization for Spherical Rectangles": the part of the solid
// angle up to an edge parallel to one side is a sum of inner angles, which is inverted for that edge; along it the
// solid angle grows with the sine of the elevation.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerosol::render {

/// A bare triple of doubles, for the geometry of lights.
struct DoubleVector {
  double x = 0, y = 0, z = 0;

  friend DoubleVector operator+(DoubleVector a, DoubleVector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend DoubleVector operator-(DoubleVector a, DoubleVector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend DoubleVector operator*(DoubleVector a, double s) { return {a.x * s, a.y * s, a.z * s}; }
};
inline double dot(DoubleVector a, DoubleVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double length(DoubleVector a) { return std::sqrt(dot(a, a)); }
inline DoubleVector cross(DoubleVector a, DoubleVector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

class SphericalRectangle {
 public:
  /// `corner` as seen from the point; `right` and `up` are the sides from there, at right angles and not zero.
  SphericalRectangle(DoubleVector corner, DoubleVector right, DoubleVector up) {
    const double width = length(right), height = length(up);
    x_ = right * (1 / width);
    y_ = up * (1 / height);
    z_ = cross(x_, y_);
    z0_ = dot(corner, z_);
    if (z0_ > 0) {
      z_ = z_ * -1;
      z0_ = -z0_;
    }
    x0_ = dot(corner, x_);
    y0_ = dot(corner, y_);
    x1_ = x0_ + width;
    y1_ = y0_ + height;
    // The z components of the unit normals of the four planes through the point and a side.
    const auto slope = [&](double a) { return a / std::sqrt(z0_ * z0_ + a * a); };
    const double below = -slope(y0_), right_ = slope(x1_), above = slope(y1_), left = -slope(x0_);
    const auto inner = [](double a, double b) { return std::acos(std::clamp(-a * b, -1.0, 1.0)); };
    below_ = below;
    above_ = above;
    offset_ = 2 * std::numbers::pi - inner(above, left) - inner(left, below);
    solidAngle_ = inner(below, right_) + inner(right_, above) - offset_;
  }

  double solidAngle() const { return solidAngle_; }

  /// The way from the point to a place of the rectangle, for u, v in [0, 1).
  DoubleVector sample(double u, double v) const {
    const double angle = u * solidAngle_ + offset_;
    const double f = (std::cos(angle) * below_ - above_) / std::sin(angle);
    const double c = std::clamp(std::copysign(1 / std::sqrt(f * f + below_ * below_), f), -1.0, 1.0);
    const double root = std::sqrt(std::max(0.0, 1 - c * c));
    const double x = root > 0 ? std::clamp(-c * z0_ / root, x0_, x1_) : x1_;
    const double d2 = x * x + z0_ * z0_, d = std::sqrt(d2);
    const double h0 = y0_ / std::sqrt(d2 + y0_ * y0_), h1 = y1_ / std::sqrt(d2 + y1_ * y1_);
    const double h = h0 + v * (h1 - h0);
    const double rest = 1 - h * h;
    const double y = rest > 0 ? std::clamp(h * d / std::sqrt(rest), y0_, y1_) : y1_;
    return x_ * x + y_ * y + z_ * z0_;
  }

 private:
  DoubleVector x_, y_, z_;
  double x0_ = 0, x1_ = 0, y0_ = 0, y1_ = 0, z0_ = 0;
  double below_ = 0, above_ = 0, offset_ = 0, solidAngle_ = 0;
};

}  // namespace aerosol::render

// Maps from the unit square to other shapes that keep areas in proportion.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/geometry.h"

namespace aerosol::render {

/// Uniform on the unit disk, neighbours stay neighbours (Shirley and Chiu 1997, "A Low Distortion Map Between Disk and
/// Square").
inline std::array<double, 2> toConcentricDisk(std::array<float, 2> u) {
  const double a = 2 * static_cast<double>(u[0]) - 1, b = 2 * static_cast<double>(u[1]) - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool isHorizontal = std::fabs(a) > std::fabs(b);
  const double r = isHorizontal ? a : b;
  const double phi =
      isHorizontal ? std::numbers::pi / 4 * (b / a) : std::numbers::pi / 2 - std::numbers::pi / 4 * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}

/// Uniform on the unit sphere; density 1 / 4π.
inline std::array<double, 3> toSphere(std::array<float, 2> u) {
  const double z = 1 - 2 * static_cast<double>(u[0]);
  const double r = 2 * std::sqrt(static_cast<double>(u[0]) * (1 - static_cast<double>(u[0])));
  const double phi = 2 * std::numbers::pi * static_cast<double>(u[1]);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// On the upper unit hemisphere with density cos / π (Malley's method).
inline std::array<double, 3> toCosineHemisphere(std::array<float, 2> u) {
  const std::array<double, 2> d = toConcentricDisk(u);
  return {d[0], d[1], std::sqrt(std::max(0.0, 1 - d[0] * d[0] - d[1] * d[1]))};
}

/// Weights of the first two corners of a triangle for a uniform point on it; the third has what is missing to 1.
inline std::array<double, 2> toTriangle(std::array<float, 2> u) {
  const double root = std::sqrt(1 - static_cast<double>(u[0]));
  return {1 - root, root * static_cast<double>(u[1])};
}

/// (x, y, z) along the axes of `frame`, with unit length after rounding.
template <class Space>
Vector<Space> alongFrame(const Frame<Space>& frame, const std::array<double, 3>& v) {
  return normalize(frame.at(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])));
}

}  // namespace aerosol::render

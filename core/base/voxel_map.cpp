#include "core/base/voxel_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aerosol {

namespace {

using Form = VoxelMap::Form;
using Triple = VoxelMap::Triple;

constexpr Form one{0, 0, 0, 1};

double at(const Form& f, const Triple& p) { return f[0] * p[0] + f[1] * p[1] + f[2] * p[2] + f[3]; }

/// The sum of the sizes of the terms: what rounding is a part of.
double sizeAt(const Form& f, const Triple& p) {
  return std::fabs(f[0] * p[0]) + std::fabs(f[1] * p[1]) + std::fabs(f[2] * p[2]) + std::fabs(f[3]);
}

Form combined(const Form& a, double factor, const Form& b) {
  Form sum;
  for (std::size_t i = 0; i < 4; ++i) sum[i] = a[i] + factor * b[i];
  return sum;
}

Form scaled(const Form& a, double factor) { return combined({}, factor, a); }

double determinant(const Triple& a, const Triple& b, const Triple& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Where three planes meet.
std::optional<Triple> meetingPoint(const std::array<Form, 3>& planes) {
  std::array<Triple, 4> columns{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) columns[c][r] = planes[r][c];
  }
  const double whole = determinant(columns[0], columns[1], columns[2]);
  if (whole == 0 || !std::isfinite(whole)) return {};
  return Triple{-determinant(columns[3], columns[1], columns[2]) / whole,
                -determinant(columns[0], columns[3], columns[2]) / whole,
                -determinant(columns[0], columns[1], columns[3]) / whole};
}

Triple corner(const Triple& lower, const Triple& upper, unsigned which) {
  Triple p;
  for (std::size_t r = 0; r < 3; ++r) p[r] = which >> r & 1u ? upper[r] : lower[r];
  return p;
}

}  // namespace

VoxelMap VoxelMap::affine(const Matrix4& fileToIndex) {
  return {{fileToIndex[0], fileToIndex[1], fileToIndex[2]}, {one, one, one}, {}};
}

VoxelMap VoxelMap::projective(const Matrix4& m) {
  VoxelMap map{{m[0], m[1], m[2]}, {m[3], m[3], m[3]}, {}};
  // The centre of the projection is where x, y and w vanish together.
  map.eye = meetingPoint({m[0], m[1], m[3]});
  return map;
}

VoxelMap VoxelMap::linearDepth(const Triple& least, const Triple& greatest, double taper, double depth,
                               const Matrix4& secondInverse) {
  const double width = greatest[0] - least[0], slices = greatest[2] - least[2];
  const double gamma = (1 / taper - 1) / depth;
  const Form w = combined(one, gamma, secondInverse[2]);
  VoxelMap map;
  for (std::size_t r = 0; r < 2; ++r) {
    const double centre = least[r] + 0.5 * (greatest[r] - least[r]);
    map.numerator[r] = combined(scaled(secondInverse[r], width), centre, w);
    map.denominator[r] = w;
  }
  map.numerator[2] = combined(scaled(secondInverse[2], slices / depth), least[2], one);
  map.denominator[2] = one;
  if (gamma != 0) map.eye = meetingPoint({secondInverse[0], secondInverse[1], w});
  return map;
}

VoxelMap VoxelMap::after(const Matrix4& m) const {
  VoxelMap result;
  const auto moved = [&](const Form& f) {
    Form g{};
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t r = 0; r < 4; ++r) g[c] += f[r] * m[r][c];
    }
    return g;
  };
  for (std::size_t r = 0; r < 3; ++r) {
    result.numerator[r] = moved(numerator[r]);
    result.denominator[r] = moved(denominator[r]);
  }
  Matrix4 inverse;
  if (eye && invert(m, inverse)) {
    Triple p;
    for (std::size_t r = 0; r < 3; ++r) p[r] = at(inverse[r], *eye);
    result.eye = p;
  }
  return result;
}

std::optional<Triple> VoxelMap::toIndex(const Triple& point) const {
  Triple index;
  for (std::size_t r = 0; r < 3; ++r) {
    const double w = at(denominator[r], point);
    if (!(w > 0)) return {};
    index[r] = at(numerator[r], point) / w;
  }
  return index;
}

std::optional<Triple> VoxelMap::toFile(const Triple& index) const {
  const auto point = meetingPoint({plane(0, index[0]), plane(1, index[1]), plane(2, index[2])});
  if (!point) return {};
  for (const Form& d : denominator) {
    if (!(at(d, *point) > 0)) return {};
  }
  return point;
}

Form VoxelMap::plane(std::size_t axis, double position) const {
  return combined(numerator[axis], -position, denominator[axis]);
}

bool VoxelMap::indexBox(const Triple& lower, const Triple& upper, Triple& least, Triple& greatest) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  least = {infinity, infinity, infinity};
  greatest = {-infinity, -infinity, -infinity};
  // A quotient of affine functions has its extremes over a box at the corners where the divisor is positive in all.
  for (unsigned which = 0; which < 8; ++which) {
    const Triple p = corner(lower, upper, which);
    for (std::size_t r = 0; r < 3; ++r) {
      const double w = at(denominator[r], p), rounding = 0x1p-48 * sizeAt(denominator[r], p);
      if (!(w > rounding)) return false;
      const double index = at(numerator[r], p) / w;
      const double slack = (0x1p-48 * sizeAt(numerator[r], p) + std::fabs(index) * rounding) / (w - rounding);
      least[r] = std::min(least[r], index - slack);
      greatest[r] = std::max(greatest[r], index + slack);
    }
  }
  return true;
}

void VoxelMap::fileBox(const Triple& least, const Triple& greatest, Triple& lower, Triple& upper) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  lower = {infinity, infinity, infinity};
  upper = {-infinity, -infinity, -infinity};
  for (unsigned which = 0; which < 8; ++which) {
    auto p = toFile(corner(least, greatest, which));
    // Voxels that begin behind the eye taper off to it.
    if (!p) p = eye;
    if (!p) continue;
    for (std::size_t r = 0; r < 3; ++r) {
      lower[r] = std::min(lower[r], (*p)[r]);
      upper[r] = std::max(upper[r], (*p)[r]);
    }
  }
}

}  // namespace aerosol

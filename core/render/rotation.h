// What environments may be placed by.
#pragma once

#include <cmath>

#include "core/base/geometry.h"

namespace aerosol::render {

/// Whether a matrix keeps lengths and angles; it may mirror.
inline bool isRotation(const Matrix4& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double product = m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
      if (std::fabs(product - (i == j ? 1 : 0)) > 1e-4) return false;
    }
  }
  return true;
}

/// A matrix without the factor on lengths that it may have, the same in all directions.
inline Matrix4 withoutScale(const Matrix4& m) {
  const double length = std::sqrt(m[0][0] * m[0][0] + m[1][0] * m[1][0] + m[2][0] * m[2][0]);
  Matrix4 unit = m;
  if (!(length > 0)) return unit;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) unit[i][j] /= length;
  }
  return unit;
}

}  // namespace aerosol::render

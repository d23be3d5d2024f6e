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

}  // namespace aerosol::render

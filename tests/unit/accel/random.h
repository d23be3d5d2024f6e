// Reproducible random numbers and shapes for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "core/base/geometry.h"
#include "core/base/hash.h"

namespace aerosol::accel {

/// SplitMix64 (Steele, Lea and Flood 2014), seeded by a name.
class Random {
 public:
  explicit Random(std::string_view name) : state_(hashString(name)) {}

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  double uniform(double lower = 0, double upper = 1) {
    return lower + (upper - lower) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  }
  float uniformFloat(double lower, double upper) { return static_cast<float>(uniform(lower, upper)); }
  Point<World> point(double reach) {
    return {uniformFloat(-reach, reach), uniformFloat(-reach, reach), uniformFloat(-reach, reach)};
  }
  Vector<World> direction() {
    const double z = uniform(-1, 1), phi = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)), static_cast<float>(z)};
  }

 private:
  std::uint64_t state_;
};

inline Transform<World, Object> makeTransform(const Matrix4& matrix) {
  Matrix4 inverse;
  invert(matrix, inverse);
  return {matrix, inverse};
}

inline Transform<World, Object> translateScale(double x, double y, double z, double sx, double sy, double sz) {
  return makeTransform({{{sx, 0, 0, x}, {0, sy, 0, y}, {0, 0, sz, z}, {0, 0, 0, 1}}});
}
inline Transform<World, Object> translateScale(double x, double y, double z, double s = 1) {
  return translateScale(x, y, z, s, s, s);
}

/// A well-conditioned map with shear, scale and every second time a mirror.
inline Transform<World, Object> randomTransform(Random& random, double reach, double size) {
  Matrix4 m = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) m[i][j] = size * random.uniform(-0.3, 0.3);
    m[i][i] += size * random.uniform(0.8, 1.5) * (random.uniform() < 0.5 ? -1 : 1);
    m[i][3] = random.uniform(-reach, reach);
  }
  return makeTransform(m);
}

}  // namespace aerosol::accel

// What the tests of the kernels' runtime library share: inputs, lanes and units in the last place.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "core/jit/runtime/wide.h"

namespace aerosol::jit::test {

/// Floats of all kinds: every bit pattern, numbers near 1, small whole numbers and halves, and the special values.
inline std::vector<float> anyFloats(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<float> values = {0.0f,      -0.0f,         1.0f,           -1.0f,      0.5f,        -0.5f,
                               2.0f,      INFINITY,      -INFINITY,      NAN,        1e-45f,      -1e-45f,
                               1.18e-38f, 3.4028235e38f, -3.4028235e38f, 131072.0f,  1e10f,       -1e30f,
                               88.72f,    -103.97f,      0.70710677f,    1.4142135f, 16777216.0f, 2147483648.0f};
  while (values.size() < count) {
    const auto bits = static_cast<std::uint32_t>(random());
    const double unit = static_cast<double>(random() >> 11) / 9007199254740992.0;
    switch (values.size() % 4) {
      case 0:
        values.push_back(std::bit_cast<float>(bits));
        break;
      case 1:
        values.push_back(static_cast<float>(unit * 20.0 - 10.0));
        break;
      case 2:
        values.push_back(static_cast<float>(static_cast<int>(bits % 64u) - 32) * 0.5f);
        break;
      default:
        values.push_back(static_cast<float>(std::exp(unit * 40.0 - 20.0)) * ((bits & 1u) != 0 ? 1.0f : -1.0f));
    }
  }
  values.resize(count);
  return values;
}

/// Same bits, or both NaN.
inline bool isSame(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// W floats of an array as lanes.
template <int W>
runtime::Wide<float, W> lanesAt(const std::vector<float>& values, std::size_t first) {
  runtime::Wide<float, W> lanes;
  std::memcpy(&lanes, values.data() + first, sizeof(lanes));
  return lanes;
}
template <class F>
void store(std::vector<float>& values, std::size_t first, const F& lanes) {
  std::memcpy(values.data() + first, &lanes, sizeof(lanes));
}

/// The error of a float in units in the last place of the reference (of the least denormal below the normal numbers).
inline double errorInUlps(float value, double reference) {
  int exponent = 0;
  std::frexp(static_cast<float>(reference), &exponent);
  return std::fabs(static_cast<double>(value) - reference) / std::ldexp(1.0, std::max(exponent - 24, -149));
}

}  // namespace aerosol::jit::test

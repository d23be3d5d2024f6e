// Colours as CIE 1931 tristimulus values.
#pragma once

#include <array>

#include "core/base/color.h"

namespace aerosol {

/// Linear Rec.709 to CIE XYZ, 1931 observer, white point D65 (IEC 61966-2-1).
constexpr std::array<float, 3> toXyz(Color c) {
  return {0.4124f * c.r + 0.3576f * c.g + 0.1805f * c.b, 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b,
          0.0193f * c.r + 0.1192f * c.g + 0.9505f * c.b};
}

}  // namespace aerosol

// A point of a triangle mesh.
#pragma once

#include <cstdint>
#include <limits>

namespace aerosol {

struct MeshPlace {
  static constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t triangle = nowhere;
  float b1 = 0, b2 = 0;  ///< Weights of the triangle's second and third corner.
};

}  // namespace aerosol

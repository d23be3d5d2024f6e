// Corners of a mesh by their places.
#pragma once

#include <cstdint>
#include <vector>

#include "core/accel/mesh.h"

namespace aerosol::accel {

/// By position: the number of one that stands for all at exactly the same place.
std::vector<std::uint32_t> weldedCorners(const TriangleMesh& mesh);

/// An edge, whichever way it is gone along.
inline std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
  return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
}

}  // namespace aerosol::accel

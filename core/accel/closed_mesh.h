// Bodies of triangles as they were meant: faces that agree which side is outside, and no holes.
#pragma once

#include <cstddef>

#include "core/accel/mesh.h"

namespace aerosol::accel {

struct MeshRepair {
  std::size_t turned = 0;       ///< Triangles that were turned around.
  std::size_t closedHoles = 0;  ///< By flat fans around their middle.
  std::size_t leftOpen = 0;     ///< Edges with a triangle on one side alone, of sheets and of holes that are no loops.
};

/// Turns triangles around that disagree with most of those they hang together with, and closes holes. A connected part
/// that is a sheet, a plane of water or a bowl (the vectors of its areas add up to more than 0.45 of its area; those of
/// a closed body cancel), stays open. Corners at the same place are one. What cannot be told inside from outside, as a
/// Möbius strip, is left alone.
MeshRepair closeBodies(TriangleMesh& mesh);

}  // namespace aerosol::accel

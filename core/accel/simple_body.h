// Meshes that bound a body in the plainest way: one inside, one outside, and no place that is inside twice.
#pragma once

#include "core/accel/mesh.h"

namespace aerosol::accel {

/// Whether it is certain that a line which enters the mesh leaves it before it enters again: the mesh is closed, its
/// faces turn outwards, and none of them meets another but at the corners and edges that they share. Bodies may be
/// hollow, of several parts, and have cavities. Corners at the same place are one. What rounding leaves open is not
/// certain.
bool isSimpleBody(const TriangleMesh& mesh);

}  // namespace aerosol::accel

// Meshes in the place of curved shapes, as coarse as they may be where they are refined afterwards.
#pragma once

#include "core/accel/refined_mesh.h"

namespace aerosol::accel {

/// A mesh with its corners on the shape, and what moves new vertices there: with the shape's own texture coordinates.
struct CurvedMesh {
  TriangleMesh mesh;
  RefinedMesh::Bend bend;
};

// The unit sphere, the unit disk in the xy plane, and the cylinder of radius 1 about the z axis from z = 0 to 1, as
// SceneBuilder has them.
CurvedMesh makeSphereMesh();
CurvedMesh makeDiskMesh();
CurvedMesh makeCylinderMesh();

}  // namespace aerosol::accel

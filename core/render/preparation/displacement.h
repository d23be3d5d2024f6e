// Displaced surfaces, as a scene is prepared.
#pragma once

#include "core/accel/refined_mesh.h"
#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Finds the displacement shaders; an instance for each shape that has one.
void bindDisplacements(Preparation& state);

/// A mesh before it is displaced, in its own space.
struct UndisplacedMesh {
  accel::TriangleMesh mesh;
  accel::RefinedMesh::Bend bend = {};     ///< Of curved shapes.
  Transform<World, Object> toWorld = {};  ///< When the shutter opens.
};

/// Refines the mesh of shape number `index` and lets its displacement shader move it: the mesh in world space as it is
/// when the shutter opens, with new normals. Their places are those of the shader where it writes N.
Result<accel::TriangleMesh> displaceMesh(Preparation& state, std::size_t index, UndisplacedMesh base);

}  // namespace aerosol::render

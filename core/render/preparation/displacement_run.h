// Runs a displacement shader on the vertices of a mesh.
#pragma once

#include <span>
#include <vector>

#include "core/accel/mesh.h"
#include "core/render/prepared_scene.h"

namespace aerosol::render {

/// A vertex as the shader is told about it, in world space.
struct DisplacementVertex {
  Point<World> point;
  Normal<World> normal;
  Vector<World> dPdu, dPdv;
  float u = 0, v = 0;
  float spacing = 0;  ///< To the next vertices, scene units.
  MeshPlace place;    ///< In the mesh whose attributes the shader finds.
};

struct DisplacedVertex {
  Point<World> point;
  Normal<World> normal;
};

/// On all cores; results and messages do not depend on how many there are. `number` is that of the first vertex, of
/// which each is asked for once, `path` what messages come from.
/// Filters of textures and derivatives reach from a vertex to the next along u (the language's x) and v (y).
std::vector<DisplacedVertex> runDisplacement(const PreparedScene& scene, shading::InstanceRef shader,
                                             const accel::TriangleMesh& mesh,
                                             std::span<const DisplacementVertex> vertices, const PathId& path,
                                             std::uint32_t number);

}  // namespace aerosol::render

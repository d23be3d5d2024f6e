// What is wrong with the geometry of meshes that bound something.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/accel/mesh.h"

namespace aerosol::app {

struct MeshDefects {
  std::size_t openEdges = 0;     ///< With a triangle on one side alone: a hole.
  std::size_t crowdedEdges = 0;  ///< With three or more.
  std::size_t turnedEdges = 0;   ///< Whose two triangles disagree which side is outside.
  std::size_t degenerate = 0;    ///< Triangles without area.
  std::size_t doubled = 0;       ///< Triangles that stand there twice.
  std::optional<Point<World>> openAt, crowdedAt, turnedAt, doubledAt;  ///< The first of each.

  bool any() const { return openEdges + crowdedEdges + turnedEdges + doubled > 0; }
};

/// Corners at exactly the same place are one, so that meshes with seams of texture coordinates are closed.
MeshDefects checkMesh(const accel::TriangleMesh& mesh);

/// Two objects with faces in one plane that overlap there.
struct CoincidentFaces {
  std::size_t first = 0, second = 0;  ///< Indices of the meshes.
  Point<World> at;
};
/// At most one entry a pair of meshes; null meshes are left out. Triangles of whose planes nothing but rounding differs
/// count as coplanar.
std::vector<CoincidentFaces> findCoincidentFaces(const std::vector<const accel::TriangleMesh*>& meshes);

}  // namespace aerosol::app

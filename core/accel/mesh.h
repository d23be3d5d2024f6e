// Triangle meshes in world space.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/mesh_place.h"

namespace aerosol::accel {

struct TexCoord {
  float u = 0, v = 0;
};

/// Numbers that shaders may ask for by name.
struct MeshAttribute {
  std::string name;           ///< Such as "vertex_color".
  int channels = 1;           ///< 1 to 4.
  bool isPerFace = false;     ///< Values belong to triangles; otherwise to positions, and are interpolated.
  std::vector<float> values;  ///< Channels of the first one, of the second one …
};

/// Triangles whose outside is the side from which their corners turn counter-clockwise. `normals` and `uvs` are empty
/// or one per position; a zero normal stands for an unknown one.
struct TriangleMesh {
  std::vector<Point<World>> positions;
  std::vector<Normal<World>> normals;
  std::vector<TexCoord> uvs;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<MeshAttribute> attributes;
  bool faceNormals = false;  ///< Shade flat: vertex normals, given or computed, are not used.
  bool flipNormals = false;  ///< Swap inside and outside.
};

/// What makes the mesh unusable (an index out of range, a position that is not finite, arrays of unequal lengths);
/// nothing when it is sound. Degenerate triangles are allowed: no ray meets them.
std::optional<std::string> findDefect(const TriangleMesh& mesh);

/// An attribute of the mesh at a place on it; channels that it does not have are 0.
std::array<float, 4> valueAt(const TriangleMesh& mesh, const MeshAttribute& attribute, const MeshPlace& place);

/// Carries out `faceNormals` and `flipNormals` and clears them. A mesh without normals that is not flat gets smooth
/// ones.
void resolveNormals(TriangleMesh& mesh);

/// Turns triangles around of which all normals of the corners point to the other side; without normals nothing.
void windByNormals(TriangleMesh& mesh);

/// Takes the mesh's coordinates as object space and moves it to world space. Under a mirroring map the winding is
/// reversed, so that the outside stays outside.
void transformMesh(TriangleMesh& mesh, const Transform<World, Object>& toWorld);

/// The cube [-1, 1]^3 with flat normals and texture coordinates in [0, 1] on each face.
TriangleMesh makeCube(const Transform<World, Object>& toWorld = {});

/// The square [-1, 1]^2 in the xy plane, facing +z; u and v run along x and y from 0 to 1.
TriangleMesh makeRectangle(const Transform<World, Object>& toWorld = {});

}  // namespace aerosol::accel

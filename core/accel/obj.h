// Triangle meshes from Wavefront OBJ files.
#pragma once

#include <string>

#include "core/accel/mesh.h"
#include "core/base/result.h"

namespace aerosol::accel {

/// Reads v, vt, vn and f (polygons are triangulated, negative indices count back from the last element); o, g, s,
/// usemtl and mtllib have no meaning here. What cannot be rendered (points, lines) is left out with a warning; what is
/// not OBJ, and free-form geometry, is an error at its line. Texture coordinates are kept as they are.
Result<TriangleMesh> loadObj(const std::string& path, const Transform<World, Object>& toWorld, Diagnostics& warnings);

/// The same from text in memory; `file` is the name in messages.
Result<TriangleMesh> parseObj(const std::string& file, std::string text, const Transform<World, Object>& toWorld,
                              Diagnostics& warnings);

}  // namespace aerosol::accel

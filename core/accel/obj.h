// Triangle meshes from Wavefront OBJ files.
#pragma once

#include <string>
#include <string_view>

#include "core/accel/mesh.h"
#include "core/base/result.h"

namespace aerosol::accel {

/// Reads v, vt, vn and f (polygons are triangulated, negative indices count back from the last element); s and mtllib
/// have no meaning here, and o, g and usemtl none but to `faces`. What cannot be rendered (points, lines) is left out
/// with a warning; what is not OBJ, and free-form geometry, is an error at its line. Texture coordinates are kept as
/// they are.
///
/// `faces`: "usemtl NAME …" takes those of these materials alone, "o NAME …" those of objects or groups; with "not "
/// before, all others. Empty: all.
Result<TriangleMesh> loadObj(const std::string& path, const Transform<World, Object>& toWorld, Diagnostics& warnings,
                             std::string_view faces = {});

/// The same from text in memory; `file` is the name in messages.
Result<TriangleMesh> parseObj(const std::string& file, std::string text, const Transform<World, Object>& toWorld,
                              Diagnostics& warnings, std::string_view faces = {});

}  // namespace aerosol::accel

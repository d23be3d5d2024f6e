// Triangle meshes from PLY files.
#pragma once

#include <string>

#include "core/accel/mesh.h"
#include "core/base/result.h"

namespace aerosol::accel {

/// Reads PLY 1.0: ASCII, binary little-endian and big-endian. Of the vertices x y z, nx ny nz and u v (or s t), of the
/// faces the list vertex_indices (or vertex_index) of any integer type. Further properties of the two that are no lists
/// become attributes "vertex_NAME" and "face_NAME": red green blue [alpha] is "color", and consecutive ones such as
/// tint_r tint_g tint_b (or x y z w, 0 1 2 3, 1 2 3 4) belong together; colours of integer types are sRGB from 0 to the
/// type's greatest. Other elements are stepped over. Errors are at a line in the header and in ASCII data and name the
/// byte in binary data.
Result<TriangleMesh> loadPly(const std::string& path, const Transform<World, Object>& toWorld, Diagnostics& warnings);

/// The same from data in memory; `file` is the name in messages.
Result<TriangleMesh> parsePly(const std::string& file, std::string data, const Transform<World, Object>& toWorld,
                              Diagnostics& warnings);

}  // namespace aerosol::accel

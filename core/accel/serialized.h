// Triangle meshes from Mitsuba's binary format.
#pragma once

#include <string>

#include "core/accel/mesh.h"
#include "core/base/result.h"

namespace aerosol::accel {

/// Reads the mesh number `index` (from 0) of a .serialized file of version 3 or 4: meshes compressed one by one, and at
/// the end of the file the place of each. Normals, texture coordinates and colours (as attribute
/// "vertex_color") are read in single or double precision. Errors name the byte of the file, which is where the mesh
/// begins for what is wrong with its decompressed content.
Result<TriangleMesh> loadSerialized(const std::string& path, int index, const Transform<World, Object>& toWorld);

/// The same from data in memory; `file` is the name in messages.
Result<TriangleMesh> parseSerialized(const std::string& file, std::string data, int index,
                                     const Transform<World, Object>& toWorld);

}  // namespace aerosol::accel

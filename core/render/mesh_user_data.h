// What shaders find of the attributes of a mesh.
#pragma once

#include <optional>
#include <span>

#include "core/accel/mesh.h"
#include "core/shading/attributes.h"

namespace aerosol::render {

/// The attribute of that name at a place of the mesh: its type, and its components in `values`; nothing when there is
/// none.
std::optional<lang::Type> meshUserData(const accel::TriangleMesh& mesh, const MeshPlace& place, std::uint64_t nameHash,
                                       std::span<float, shading::PointFacts::maximumUserData> values);

}  // namespace aerosol::render

#include "core/render/mesh_user_data.h"

#include <algorithm>

#include "core/base/hash.h"

namespace aerosol::render {

namespace {

lang::Type typeOf(const accel::MeshAttribute& attribute) {
  if (attribute.channels == 1) return lang::types::floating;
  return attribute.channels == 3 ? lang::types::color : lang::types::floating.arrayOf(attribute.channels);
}

}  // namespace

std::optional<lang::Type> meshUserData(const accel::TriangleMesh& mesh, const MeshPlace& place, std::uint64_t nameHash,
                                       std::span<float, shading::PointFacts::maximumUserData> values) {
  if (place.triangle >= mesh.triangles.size()) return {};
  for (const accel::MeshAttribute& attribute : mesh.attributes) {
    if (hashString(attribute.name) != nameHash) continue;
    const std::array<float, 4> found = valueAt(mesh, attribute, place);
    std::copy_n(found.begin(), attribute.channels, values.begin());
    return typeOf(attribute);
  }
  return {};
}

}  // namespace aerosol::render

#include "core/render/preparation/mesh_files.h"

#include "core/accel/obj.h"
#include "core/accel/ply.h"
#include "core/accel/serialized.h"

namespace aerosol::render {

namespace {

Result<accel::TriangleMesh> read(const scene::Shape& shape, Diagnostics& warnings) {
  const std::string file = shape.file.string();
  if (shape.type == scene::ShapeType::serialized) return accel::loadSerialized(file, shape.shapeIndex, {});
  return shape.type == scene::ShapeType::obj ? accel::loadObj(file, {}, warnings, shape.faces)
                                             : accel::loadPly(file, {}, warnings);
}

/// Triangles that are saved above which a mesh is shared.
constexpr std::size_t mostCopies = 1 << 16;

/// What moves, shines or is displaced has triangles of its own.
bool canShare(const scene::Shape& shape) {
  return shape.isFromFile() && !shape.emitter && !shape.displacement && shape.toWorld.keys.empty();
}

bool flipsTexCoords(const scene::Shape& shape) {
  return shape.flipTexCoords.value_or(shape.type == scene::ShapeType::obj);
}

/// Materials go by the normals of the corners, as in Mitsuba, whose scenes do not always wind their triangles alike;
/// media by the triangles.
bool isWoundByNormals(const scene::Shape& shape) { return shape.isFromFile() && !shape.interior && !shape.exterior; }

}  // namespace

void applyFlags(const scene::Shape& shape, accel::TriangleMesh& mesh) {
  if (shape.isFromFile() && flipsTexCoords(shape)) {
    for (accel::TexCoord& uv : mesh.uvs) uv.v = 1 - uv.v;
  }
  mesh.faceNormals = mesh.faceNormals || shape.faceNormals;
  mesh.flipNormals = shape.flipNormals;
  if (!mesh.faceNormals && isWoundByNormals(shape)) accel::windByNormals(mesh);
}

MeshFiles::SharedKey MeshFiles::sharedKeyOf(const scene::Shape& shape) {
  return {keyOf(shape), shape.faceNormals, shape.flipNormals, flipsTexCoords(shape), isWoundByNormals(shape)};
}

MeshFiles::MeshFiles(const scene::SceneDescription& description) {
  for (const scene::Shape& shape : description.shapes) {
    if (shape.isFromFile()) ++entries_[keyOf(shape)].uses;
    if (canShare(shape)) ++shared_[sharedKeyOf(shape)].uses;
  }
}

Result<std::optional<accel::SharedMeshId>> MeshFiles::shared(const scene::Shape& shape, accel::SceneBuilder& builder,
                                                             Diagnostics& warnings) {
  using Found = std::optional<accel::SharedMeshId>;
  if (!canShare(shape)) return Found();
  SharedEntry& entry = shared_[sharedKeyOf(shape)];
  if (entry.isDecided || entry.uses < 2) return entry.mesh;
  entry.isDecided = true;
  Entry& file = entries_[keyOf(shape)];
  if (!file.mesh) file.mesh.emplace(read(shape, warnings));
  if (!*file.mesh || (**file.mesh).triangles.size() * (entry.uses - 1) < mostCopies) return Found();
  file.uses -= entry.uses - 1;
  auto mesh = load(shape, {}, warnings);
  if (!mesh) return mesh.errors();
  applyFlags(shape, *mesh);
  auto added = builder.addShared(std::move(*mesh));
  if (!added) return added.errors();
  entry.mesh = *added;
  return entry.mesh;
}

Result<accel::TriangleMesh> MeshFiles::load(const scene::Shape& shape, const Transform<World, Object>& toWorld,
                                            Diagnostics& warnings) {
  Entry& entry = entries_[keyOf(shape)];
  if (!entry.mesh) entry.mesh.emplace(read(shape, warnings));
  const bool isLast = entry.uses <= 1;
  if (!isLast) --entry.uses;
  Result<accel::TriangleMesh> mesh = isLast ? std::move(*entry.mesh) : *entry.mesh;
  if (isLast) entry.mesh.reset();
  if (mesh) accel::transformMesh(*mesh, toWorld);
  return mesh;
}

}  // namespace aerosol::render

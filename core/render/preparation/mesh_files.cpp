#include "core/render/preparation/mesh_files.h"

#include "core/accel/obj.h"
#include "core/accel/ply.h"
#include "core/accel/serialized.h"

namespace aerosol::render {

namespace {

Result<accel::TriangleMesh> read(const scene::Shape& shape, Diagnostics& warnings) {
  const std::string file = shape.file.string();
  if (shape.type == scene::ShapeType::serialized) return accel::loadSerialized(file, shape.shapeIndex, {});
  return shape.type == scene::ShapeType::obj ? accel::loadObj(file, {}, warnings) : accel::loadPly(file, {}, warnings);
}

}  // namespace

MeshFiles::MeshFiles(const scene::SceneDescription& description) {
  for (const scene::Shape& shape : description.shapes) {
    if (shape.isFromFile()) ++entries_[keyOf(shape)].uses;
  }
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

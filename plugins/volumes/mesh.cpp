// The inside of a triangle mesh as a volume primitive.

#include <fmt/format.h>

#include "core/accel/mesh_volume.h"
#include "core/accel/obj.h"
#include "core/accel/ply.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

Result<accel::TriangleMesh> load(const std::filesystem::path& file, Diagnostics& warnings) {
  const std::string extension = file.extension().string();
  if (extension == ".obj") return accel::loadObj(file.string(), {}, warnings);
  if (extension == ".ply") return accel::loadPly(file.string(), {}, warnings);
  Diagnostic error;
  error.message = fmt::format("'{}' is no mesh file", file.string());
  error.notes.push_back("meshes are read from .obj and .ply files");
  return error;
}

Result<std::unique_ptr<const accel::VolumeShape>> make(const VolumeArguments& arguments) {
  const std::filesystem::path file = arguments.file("filename");
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    return Diagnostic{Severity::error,
                      arguments.volume.origin.of("filename"),
                      fmt::format("there is no file '{}'", file.string()),
                      {},
                      {}};
  }
  Result<accel::TriangleMesh> mesh = load(file, arguments.warnings);
  if (!mesh) return mesh.errors();
  const accel::MeshTopology topology = accel::examine(*mesh);
  if (!topology.isClosed()) {
    arguments.warnings.warning(
        arguments.volume.origin.location,
        fmt::format("'{}' is not closed: {} of its edges belong to one triangle only", file.string(),
                    topology.openEdges),
        {"rays that enter without leaving see nothing of the volume: close the mesh where it is modelled"});
  } else if (!topology.isOriented()) {
    arguments.warnings.warning(
        arguments.volume.origin.location,
        fmt::format("the triangles of '{}' do not all turn alike ({} edges)", file.string(), topology.flippedEdges),
        {"surfaces are paired along each ray instead of being counted; where parts overlap is a hole: make the "
         "windings consistent where the mesh is modelled"});
  }
  return accel::MeshVolume::make(std::move(*mesh), arguments.toWorld);
}

}  // namespace

void registerVolume_mesh(Registry& registry) {
  registry.add(VolumeType{
      .described = {.type = "mesh",
                    .doc =
                        "the inside of a closed triangle mesh, concave or not; its shader's object space is the file's",
                    .parameters = {{.name = "filename",
                                    .type = scene::ValueType::string,
                                    .doc = "an .obj or .ply file, looked up beside the scene",
                                    .required = true}}},
      .place = [](const scene::Volume& volume) { return volume.toWorld; },
      .make = make});
}

}  // namespace aerosol::render

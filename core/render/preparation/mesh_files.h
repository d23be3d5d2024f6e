// The meshes of a scene's files, each read once.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>

#include "core/accel/mesh.h"
#include "core/base/result.h"
#include "core/scene/description.h"

namespace aerosol::render {

class MeshFiles {
 public:
  explicit MeshFiles(const scene::SceneDescription& description);

  /// The mesh of a shape that is from a file. It is kept while shapes to come have the same.
  Result<accel::TriangleMesh> load(const scene::Shape& shape, const Transform<World, Object>& toWorld,
                                   Diagnostics& warnings);

 private:
  using Key = std::tuple<scene::ShapeType, std::string, int>;
  struct Entry {
    std::size_t uses = 0;  ///< To come.
    std::optional<Result<accel::TriangleMesh>> mesh;
  };
  static Key keyOf(const scene::Shape& shape) { return {shape.type, shape.file.string(), shape.shapeIndex}; }

  std::map<Key, Entry> entries_;
};

}  // namespace aerosol::render

// The meshes of a scene's files, each read once.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>

#include "core/accel/scene.h"
#include "core/base/result.h"
#include "core/scene/description.h"

namespace aerosol::render {

/// Turns texture coordinates around, and notes what is to be done with normals, as the shape says.
void applyFlags(const scene::Shape& shape, accel::TriangleMesh& mesh);

/// A mesh stands in a scene as triangles of its own wherever that is small: rays find them the fastest. Where many
/// shapes show one large mesh, it is kept once, in its own space.
class MeshFiles {
 public:
  explicit MeshFiles(const scene::SceneDescription& description);

  /// The mesh of the shape as the builder keeps it for all that show the same; nothing where each has its own.
  Result<std::optional<accel::SharedMeshId>> shared(const scene::Shape& shape, accel::SceneBuilder& builder,
                                                    Diagnostics& warnings);

  /// The mesh of a shape that is from a file. It is kept while shapes to come have the same.
  Result<accel::TriangleMesh> load(const scene::Shape& shape, const Transform<World, Object>& toWorld,
                                   Diagnostics& warnings);

 private:
  using Key = std::tuple<scene::ShapeType, std::string, std::string, int>;
  struct Entry {
    std::size_t uses = 0;  ///< To come.
    std::optional<Result<accel::TriangleMesh>> mesh;
  };
  static Key keyOf(const scene::Shape& shape) {
    return {shape.type, shape.file.string(), shape.faces, shape.shapeIndex};
  }

  /// And what is done to it: face normals, flipped normals, flipped texture coordinates, winding by normals.
  using SharedKey = std::tuple<Key, bool, bool, bool, bool>;
  struct SharedEntry {
    std::size_t uses = 0;
    std::optional<accel::SharedMeshId> mesh;
    bool isDecided = false;
  };
  static SharedKey sharedKeyOf(const scene::Shape& shape);

  std::map<Key, Entry> entries_;
  std::map<SharedKey, SharedEntry> shared_;
};

}  // namespace aerosol::render

// The inside of a triangle mesh as a volume primitive.
#pragma once

#include <memory>

#include "core/accel/mesh.h"
#include "core/accel/volume_shape.h"
#include "core/base/result.h"

namespace aerosol::accel {

/// How well a mesh bounds a volume.
struct MeshTopology {
  std::size_t openEdges = 0;     ///< Edges of one triangle only.
  std::size_t flippedEdges = 0;  ///< Edges whose two triangles turn against each other.
  std::size_t crowdedEdges = 0;  ///< Edges of three or more triangles.

  bool isClosed() const { return openEdges == 0; }
  bool isOriented() const { return flippedEdges == 0; }
};
/// Corners at the same position are one, whatever their indices.
MeshTopology examine(const TriangleMesh& mesh);

/// The rule. All crossings of the infinite line are found, wherever the ray starts. Where the triangles turn alike, the
/// winding number counts them: entering adds 1, leaving takes 1 away, and inside is where the number is not 0; shells
/// that overlap or cross themselves are one volume, a shell turned inside out is as full as any other, and one turned
/// inwards within another is a hole. Otherwise crossings are paired in order (parity).
///
/// Through a hole a line enters without leaving. Each crossing that finds no partner is dropped, so that an opening
/// never throws a streak to the end of the ray: an entry pairs with the next exit, an unpaired one with nothing. Such
/// lines are reported by `intersect`.
class MeshVolume final : public VolumeShape {
 public:
  /// The mesh in its own coordinates. What is wrong with it is an error without a location.
  static Result<std::unique_ptr<const VolumeShape>> make(TriangleMesh objectMesh,
                                                         const Transform<World, Object>& toWorld);
  ~MeshVolume() override;

  Box<World> worldBounds() const override;
  Box<Object> objectBounds() const override;
  bool intersect(const Ray<World>& ray, IntervalSink& intervals) const override;

 private:
  struct Data;
  explicit MeshVolume(std::unique_ptr<const Data> data);

  std::unique_ptr<const Data> data_;
};

}  // namespace aerosol::accel

// The content of a Scene. Internal to this folder.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/accel/curve_surface.h"
#include "core/accel/embree.h"
#include "core/accel/moving.h"
#include "core/accel/scene.h"
#include "core/accel/surfaces.h"

namespace aerosol::accel {

/// How a surface moves. A mesh has an acceleration structure of its own, in the space that moves.
struct SurfaceMotion {
  explicit SurfaceMotion(MovingPlacement placed) : placement(std::move(placed)) {}
  ~SurfaceMotion() {
    if (mesh) rtcReleaseScene(mesh);
  }
  SurfaceMotion(const SurfaceMotion&) = delete;
  SurfaceMotion& operator=(const SurfaceMotion&) = delete;

  MovingPlacement placement;
  Box<World> atRest;
  std::vector<Box<World>> steps;
  RTCScene mesh = nullptr;
};

/// A mesh in its own space, and its acceleration structure there.
struct SharedMesh {
  explicit SharedMesh(TriangleMesh shared) : surface{0, false, std::move(shared)} {
    for (const auto& triangle : surface.mesh.triangles) {
      for (const std::uint32_t corner : triangle) bounds.extend(surface.mesh.positions[corner]);
    }
  }
  ~SharedMesh() {
    if (scene) rtcReleaseScene(scene);
  }
  SharedMesh(const SharedMesh&) = delete;
  SharedMesh& operator=(const SharedMesh&) = delete;

  MeshSurface surface;  ///< Of which object it is, the query knows.
  Box<World> bounds;
  RTCScene scene = nullptr;
};

/// A shared mesh at its place.
struct MeshInstance {
  const SharedMesh* shared = nullptr;
  ObjectId object = 0;
  bool passThrough = false;
  Transform<World, Object> toWorld;

  Box<World> worldBounds() const;
};

/// One of the first four pointers is set; the last one where the surface moves.
struct Surface {
  std::unique_ptr<const MeshSurface> mesh;
  std::unique_ptr<const AnalyticSurface> analytic;
  std::unique_ptr<const MeshInstance> instance = nullptr;
  std::unique_ptr<const CurveSurface> curves = nullptr;
  std::unique_ptr<SurfaceMotion> motion = nullptr;

  /// In the space where the surface rests; null where it has no mesh.
  const MeshSurface* restingMesh() const { return instance ? &instance->shared->surface : mesh.get(); }
  /// From the space where the surface rests; nothing where that is the world.
  std::optional<Transform<World, Object>> placement(float time) const {
    if (motion) return motion->placement.at(time);
    if (instance) return instance->toWorld;
    return {};
  }
  bool restsInWorld() const { return !motion && !instance; }
};

struct SceneData {
  SceneData() = default;
  ~SceneData() {
    if (scene) rtcReleaseScene(scene);
    surfaces.clear();
    shared.clear();
    if (device) rtcReleaseDevice(device);
  }
  SceneData(const SceneData&) = delete;
  SceneData& operator=(const SceneData&) = delete;

  std::vector<Surface> surfaces;                              ///< By ObjectId.
  std::vector<std::unique_ptr<SharedMesh>> shared;            ///< By SharedMeshId.
  std::vector<std::unique_ptr<const VolumeShape>> volumes;    ///< By VolumeId.
  std::vector<std::optional<MovingPlacement>> volumeMotions;  ///< By VolumeId.
  std::vector<std::uint32_t> visibleTo;                       ///< By ObjectId, kinds of rays; empty: all are to all.
  std::vector<bool> shadowsPass;                              ///< By ObjectId; what is missing stops them.

  // Set by build:
  std::vector<const AnalyticSurface*> analytic;   ///< By primitive of Embree's geometry for them.
  std::vector<VolumeId> bounded;                  ///< By primitive of Embree's geometry for volumes.
  std::vector<VolumeId> unbounded;                ///< Volumes tested against every ray.
  std::vector<const MeshInstance*> instances;     ///< By primitive of Embree's geometry for them.
  std::vector<ObjectId> movingSurfaces;           ///< By primitive of Embree's geometry for them.
  std::vector<const MovingVolume*> movingShapes;  ///< By primitive of Embree's geometry for moving volumes,
  std::vector<VolumeId> movingVolumes;            ///< and which they are.
  OverlapDesign overlap = OverlapDesign::split;
  VolumePartition partition;  ///< Of the bounded volumes, where that is the design.
  Box<World> bounds;
  std::string isa;
  Shutter shutter;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

/// Embree's callbacks; each reaches the running query through its context. The user pointer of a mesh's geometry is its
/// MeshSurface, that of fibres their CurveSurface, that of the other geometries the SceneData.
void acceptTriangle(const RTCFilterFunctionNArguments* arguments);
void acceptShadowTriangle(const RTCFilterFunctionNArguments* arguments);
void acceptCurve(const RTCFilterFunctionNArguments* arguments);
void acceptShadowCurve(const RTCFilterFunctionNArguments* arguments);
void intersectAnalytic(const RTCIntersectFunctionNArguments* arguments);
void occludeAnalytic(const RTCOccludedFunctionNArguments* arguments);
void recordVolume(const RTCIntersectFunctionNArguments* arguments);
void recordShadowVolume(const RTCOccludedFunctionNArguments* arguments);
void intersectInstance(const RTCIntersectFunctionNArguments* arguments);
void occludeInstance(const RTCOccludedFunctionNArguments* arguments);
void intersectMoving(const RTCIntersectFunctionNArguments* arguments);
void occludeMoving(const RTCOccludedFunctionNArguments* arguments);
void recordMovingVolume(const RTCIntersectFunctionNArguments* arguments);
void recordMovingShadowVolume(const RTCOccludedFunctionNArguments* arguments);

}  // namespace aerosol::accel

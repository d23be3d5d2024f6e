// The content of a Scene. Internal to this folder.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

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

/// One of the first two pointers is set; the last one where the surface moves.
struct Surface {
  std::unique_ptr<const MeshSurface> mesh;
  std::unique_ptr<const AnalyticSurface> analytic;
  std::unique_ptr<SurfaceMotion> motion = nullptr;
};

struct SceneData {
  SceneData() = default;
  ~SceneData() {
    if (scene) rtcReleaseScene(scene);
    surfaces.clear();
    if (device) rtcReleaseDevice(device);
  }
  SceneData(const SceneData&) = delete;
  SceneData& operator=(const SceneData&) = delete;

  std::vector<Surface> surfaces;                              ///< By ObjectId.
  std::vector<std::unique_ptr<const VolumeShape>> volumes;    ///< By VolumeId.
  std::vector<std::optional<MovingPlacement>> volumeMotions;  ///< By VolumeId.
  std::vector<bool> shadowsPass;                              ///< By ObjectId; what is missing stops them.

  // Set by build:
  std::vector<const AnalyticSurface*> analytic;   ///< By primitive of Embree's geometry for them.
  std::vector<VolumeId> bounded;                  ///< By primitive of Embree's geometry for volumes.
  std::vector<VolumeId> unbounded;                ///< Volumes tested against every ray.
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
/// MeshSurface, that of the other geometries the SceneData.
void acceptTriangle(const RTCFilterFunctionNArguments* arguments);
void acceptShadowTriangle(const RTCFilterFunctionNArguments* arguments);
void intersectAnalytic(const RTCIntersectFunctionNArguments* arguments);
void occludeAnalytic(const RTCOccludedFunctionNArguments* arguments);
void recordVolume(const RTCIntersectFunctionNArguments* arguments);
void recordShadowVolume(const RTCOccludedFunctionNArguments* arguments);
void intersectMoving(const RTCIntersectFunctionNArguments* arguments);
void occludeMoving(const RTCOccludedFunctionNArguments* arguments);
void recordMovingVolume(const RTCIntersectFunctionNArguments* arguments);
void recordMovingShadowVolume(const RTCOccludedFunctionNArguments* arguments);

}  // namespace aerosol::accel

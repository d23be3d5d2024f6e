// The content of a Scene. Internal to this folder.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/accel/embree.h"
#include "core/accel/scene.h"
#include "core/accel/surfaces.h"

namespace aerosol::accel {

/// One of the two pointers is set.
struct Surface {
  std::unique_ptr<const MeshSurface> mesh;
  std::unique_ptr<const AnalyticSurface> analytic;
};

struct SceneData {
  SceneData() = default;
  ~SceneData() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  SceneData(const SceneData&) = delete;
  SceneData& operator=(const SceneData&) = delete;

  std::vector<Surface> surfaces;                            ///< By ObjectId.
  std::vector<std::unique_ptr<const VolumeShape>> volumes;  ///< By VolumeId.

  // Set by build:
  std::vector<const AnalyticSurface*> analytic;  ///< By primitive of Embree's geometry for them.
  std::vector<VolumeId> bounded;                 ///< By primitive of Embree's geometry for volumes.
  std::vector<VolumeId> unbounded;               ///< Volumes tested against every ray.
  OverlapDesign overlap = OverlapDesign::split;
  VolumePartition partition;  ///< Of the bounded volumes, where that is the design.
  Box<World> bounds;
  std::string isa;
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

}  // namespace aerosol::accel

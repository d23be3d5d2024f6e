// Voxels in the frustum of a camera.
#pragma once

#include "core/base/result.h"
#include "core/base/voxel_map.h"
#include "core/grid/grid_writer.h"
#include "core/render/camera.h"

namespace aerosol::render {

enum class FrustumDepth : std::uint8_t {
  linear,     ///< Even steps of depth: OpenVDB's NonlinearFrustumMap.
  projective  ///< Even steps of 1 / depth, as a depth buffer has them: finer near the camera.
};

/// How voxels are to stand in a frustum.
struct FrustumOptions {
  double voxelSize = 0;  ///< Width of a voxel at the near end, > 0. Farther away they are wider, as the view is.
  int slices = 0;        ///< Voxels along the depth; 0: about as deep, in the middle, as they are wide there.
  FrustumDepth depth = FrustumDepth::linear;
  float time = 0;  ///< Of a camera that moves, seconds.
};

/// Voxels 0 to size - 1 fill what the camera sees of the depths between the ends of a box.
struct CameraFrustum {
  VoxelMap map;           ///< From world space.
  grid::NewFrustum file;  ///< The same for files.
  std::array<std::int64_t, 3> size{};
};

/// An error, without a place, for cameras without perspective and boxes that none of is in front of the camera. A
/// lens is taken as a pinhole.
Result<CameraFrustum> makeCameraFrustum(const scene::Sensor& sensor, const scene::Film& film, const Box<World>& bounds,
                                        const FrustumOptions& options);

}  // namespace aerosol::render

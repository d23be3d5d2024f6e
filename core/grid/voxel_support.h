// How far interpolation reaches.
#pragma once

#include "core/base/voxel_grid.h"

namespace aerosol::grid {

/// Voxels v are read by a lookup at p when floor(p) is from v - before to v + behind; the support of a voxel is open
/// by `reach` to both sides.
struct VoxelSupport {
  int before, behind;
  double reach;
};

inline VoxelSupport supportOf(VoxelInterpolation interpolation) {
  switch (interpolation) {
    case VoxelInterpolation::nearest:
      return {1, 0, 0.5};
    case VoxelInterpolation::trilinear:
      return {1, 0, 1};
    case VoxelInterpolation::tricubic:
      return {2, 1, 2};
  }
  return {2, 1, 2};
}

}  // namespace aerosol::grid

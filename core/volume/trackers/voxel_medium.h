// A medium whose coefficients are a field of voxels times constants.
#pragma once

#include <memory>

#include "core/volume/medium.h"
#include "core/volume/trackers/voxel_field.h"

namespace aerosol::volume {

/// Const after preparation.
struct VoxelMedium {
  std::shared_ptr<const VoxelField> field;  ///< Shared by the media that read the same grid.
  Coefficients unit;                        ///< Where the field is 1; none of them is negative.
  Matrix4 objectToIndex;
  Transform<World, Object> objectToWorld;  ///< Of a medium that does not move.

  /// A world ray in the field's coordinates, in double.
  FieldRay seenFrom(const Medium& medium, const Ray<World>& ray) const {
    const Matrix4 inverse = medium.motion ? medium.motion->at(ray.time).inverseMatrix() : objectToWorld.inverseMatrix();
    const Matrix4 m = multiply(objectToIndex, inverse);
    FieldRay result;
    for (std::size_t r = 0; r < 3; ++r) {
      result.origin[r] = m[r][3];
      for (std::size_t c = 0; c < 3; ++c) {
        const int axis = static_cast<int>(c);
        result.origin[r] += m[r][c] * static_cast<double>(ray.origin[axis]);
        result.direction[r] += m[r][c] * static_cast<double>(ray.direction[axis]);
      }
    }
    return result;
  }
};

}  // namespace aerosol::volume

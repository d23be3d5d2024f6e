// Interpolated values of many points. Internal to the module.
#pragma once

#include <cstddef>

#include "core/base/voxel_grid.h"
#include "core/grid/module/directory.h"

namespace aerosol::grid {

struct LookupArguments {
  const Directory* directory = nullptr;
  const double* fileToIndex = nullptr;  ///< Rows of a map on column vectors: 12 numbers.
  const double* divisors = nullptr;     ///< Likewise, what each coordinate is to be divided by; null: by 1.
  std::size_t count = 0;
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  float* results = nullptr;  ///< Channel after channel.
};

/// The instruction set is chosen by what the processor has; all of them give the same bits.
void lookUp(VoxelInterpolation interpolation, const LookupArguments& arguments);

}  // namespace aerosol::grid

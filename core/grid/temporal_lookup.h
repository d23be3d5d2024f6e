// Interpolated values of curves at many points and times. Internal to this folder.
#pragma once

#include <cstdint>

#include "core/base/voxel_grid.h"
#include "core/grid/lanes.h"

namespace aerosol::grid {

/// Where the curves of a grid are: tables that belong to it. Numbers of curves and of knots fit 31 bits.
struct CurveTables {
  std::int32_t channels = 1, timeCount = 0;
  std::int32_t first[3] = {}, size[3] = {};  ///< Of the blocks, in blocks.
  const std::int32_t* blocks = nullptr;      ///< z fastest: number of the block, or -1. At least one entry.
  const std::uint8_t* counts = nullptr;      ///< By curve: how many knots it has.
  const std::int32_t* rows = nullptr;        ///< By row of `curvesInRow` curves: its first knot.
  const std::uint8_t* knots = nullptr;       ///< By knot: the number of its time. Four more bytes may be read behind.
  const float* values = nullptr;             ///< By knot.
  const float* times = nullptr;
};

inline constexpr int curvesInRow = 4, curvesInBlock = 512;

/// The instruction set is chosen by what the processor has; all of them give the same bits.
void lookUp(VoxelInterpolation interpolation, const CurveTables& curves, const LookupPoints& points);

}  // namespace aerosol::grid

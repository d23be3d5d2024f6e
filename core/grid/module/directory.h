// Where voxels are, for lookups of many points at once. Internal to the module.
//
// NanoVDB's tree keeps 64-bit offsets in nodes of 32^3, 16^3 and 8^3 children; walking it takes a branch a level.
// Beside it stands a directory of two flat tables that any point goes through without a branch: `blocks` over boxes of
// 128^3 voxels around everything stored, with one layer of empty ones around; and of each block a table of 16^3
// entries, each the place of a leaf's 512 values in NanoVDB's own memory, or of one constant.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace aerosol::grid {

inline constexpr int blockBits = 7, leafBits = 3;
inline constexpr int tableSize = 4096;

/// Least and greatest of a set of values, NaN left out; empty: least > greatest.
struct ValueRange {
  float least = __builtin_inff(), greatest = -__builtin_inff();
  bool hasNan = false;

  void add(float value) {
    if (value != value) hasNan = true;
    if (value < least) least = value;
    if (value > greatest) greatest = value;
  }
  void add(const ValueRange& other) {
    hasNan = hasNan || other.hasNan;
    if (other.least < least) least = other.least;
    if (other.greatest > greatest) greatest = other.greatest;
  }
};
using ChannelRanges = std::array<ValueRange, 3>;

struct Directory {
  int channels = 1;
  std::int32_t origin[3] = {};       ///< Index-space position of the first block.
  std::int32_t size[3] = {};         ///< Blocks along each axis.
  std::vector<std::int32_t> blocks;  ///< x fastest: number of the block's table. Table 0 is the background's.
  std::vector<std::int32_t>
      entries;                    ///< Table after table, z fastest: where a leaf's values begin, or ~ of a constant.
  const float* values = nullptr;  ///< Of leaves; `channels` floats a value.
  std::vector<float> constants;   ///< Of tiles; the first is the background.

  std::int32_t leafStride = 1;             ///< Floats from one leaf's values to the next.
  std::vector<ChannelRanges> leafRanges;   ///< By leaf.
  std::vector<ChannelRanges> tableRanges;  ///< By table.
  ChannelRanges total;                     ///< Of everything, the background included.

  const float* constant(std::int32_t entry) const { return constants.data() + ~entry; }
};

}  // namespace aerosol::grid

// Voxels that change with time: a file of curves, one a voxel.
//
// The format, all numbers little-endian and without gaps:
//
//   "AVT1"                          four bytes
//   u32                             number of grids; then grid by grid:
//   u32, bytes                      length of the name, and the name
//   u32                             channels, 1 or 3
//   f64[16]                         index space to the file's space, row by row, for column vectors
//   u32, f32[…]                     number of times (1 to 255), and the times in seconds, ascending
//   u32                             number of blocks of 8 x 8 x 8 voxels; then block by block:
//     i32[3]                        least index, multiples of 8; no two blocks alike
//     u8[channels * 512]            knots of each curve, 0: the value is always 0. Channel after channel; within one
//                                   ((x * 8 + y) * 8 + z)
//     u8[…]                         of each knot, curve after curve: the number of its time, ascending in a curve
//     f32[…]                        of each knot: the value
//
// Between two knots values change evenly; before the first and after the last they stand still. Where there is no block
// the value is 0.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/voxel_grid.h"

namespace aerosol::grid {

/// Values of 8 x 8 x 8 voxels at all times of a grid: `values[(time * channels + channel) * 512 + voxel]`.
struct TemporalSamples {
  std::array<std::int32_t, 3> origin{};
  std::vector<float> values;
};

/// The curves of one grid.
struct TemporalCurves {
  std::string name;
  int channels = 1;
  std::array<double, 16> indexToFile{};
  std::vector<float> times;
  std::vector<std::array<std::int32_t, 3>> origins;  ///< By block.
  std::vector<std::uint8_t> counts;                  ///< Knots of each curve, block after block.
  std::vector<std::uint8_t> knots;
  std::vector<float> values;

  /// Adds a block, with curves that are nowhere more than `error` from the samples. A block of zeros is left out.
  void add(const TemporalSamples& samples, float error);
  /// Adds the blocks of another one with the same times.
  void append(const TemporalCurves& other);
};

Diagnostics writeTemporal(const std::string& path, std::span<const TemporalCurves> grids);

/// Whether the name's extension is that of such a file: .avt in any case.
bool isTemporalFile(std::string_view path);

/// What does not follow the format is an error that names the file.
Result<std::shared_ptr<const VoxelFile>> readTemporal(const std::string& path);

}  // namespace aerosol::grid

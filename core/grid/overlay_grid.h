// A regular grid laid over voxels that stand in a frustum.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/grid/active_tree.h"
#include "core/grid/kd_tree.h"

namespace aerosol::grid {

/// Cells of equal size in the file's space, occupied where a block of voxels may meet them (Museth 2014; the talk's
/// alternative to planes that are carried over). Cells reach beyond the blocks that they stand for: what is found is a
/// superset of what a KdTree finds. Const.
class OverlayGrid {
 public:
  OverlayGrid() = default;
  /// `resolution` cells along the longest side of the box around the voxels, at least 1.
  OverlayGrid(const KdTree& blocks, const VoxelMap& map, int resolution);

  bool empty() const { return bits_.empty(); }
  std::uint64_t bytes() const { return bits_.size() * sizeof(std::uint64_t); }
  /// The part of the cells that is occupied.
  double occupied() const;

  /// Where the infinite line is in occupied cells. In the file's space.
  void walk(const std::array<double, 3>& origin, const std::array<double, 3>& direction, IntervalTaker& taker) const;

 private:
  std::size_t numberOf(const std::array<int, 3>& cell) const {
    return static_cast<std::size_t>(cell[0]) +
           static_cast<std::size_t>(size_[0]) *
               (static_cast<std::size_t>(cell[1]) +
                static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(cell[2]));
  }
  bool isOccupied(const std::array<int, 3>& cell) const {
    const std::size_t n = numberOf(cell);
    return (bits_[n / 64] >> (n % 64) & 1u) != 0;
  }

  std::array<double, 3> lower_{};
  double cellSize_ = 1;
  std::array<int, 3> size_{};
  std::vector<std::uint64_t> bits_;
};

}  // namespace aerosol::grid

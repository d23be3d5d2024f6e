// Where something of a voxel grid can be: a sparse hierarchy over blocks of voxels, and the walk of a line through it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/voxel_grid.h"

namespace aerosol::grid {

/// Who takes the intervals of a line: ascending, disjoint, t0 < t1.
class IntervalTaker {
 public:
  virtual void add(double t0, double t1) = 0;

 protected:
  ~IntervalTaker() = default;
};

/// The blocks of 8^3 voxels in which an interpolation of active voxels is more than background, cut to the box around
/// them. A tree of nodes with 4 x 4 x 4 children, one bit each for "partly" and "wholly"; only nodes that are partly
/// occupied exist. Index space throughout: voxel centres at whole numbers. Const.
class ActiveTree {
 public:
  static constexpr int blockBits = 3;  ///< log2 of the voxels along a block's edge.

  ActiveTree() = default;
  /// `active` boxes hold all active voxels; they may overlap.
  ActiveTree(std::span<const VoxelBox> active, VoxelInterpolation interpolation);

  bool empty() const { return nodes_.empty(); }
  /// The box around everything occupied.
  const std::array<double, 3>& lower() const { return lower_; }
  const std::array<double, 3>& upper() const { return upper_; }
  std::uint64_t bytes() const { return nodes_.size() * sizeof(Node); }

  /// Where the infinite line is in occupied blocks. Blocks are half-open, so a line along a face is in the upper one.
  ///
  /// Hierarchical DDA (Museth 2014, "Hierarchical Digital Differential Analyzer for Efficient Ray-Marching in
  /// OpenVDB"): from the largest cell that is alike all over to the next, by whole steps over the face through which
  /// the line leaves.
  void walk(const std::array<double, 3>& origin, const std::array<double, 3>& direction, IntervalTaker& taker) const;

 private:
  struct Node {
    std::uint64_t partly = 0, wholly = 0;  ///< By child, x fastest.
    std::uint32_t first = 0;               ///< Node of the first child that is partly occupied.
  };
  using Cell = std::array<std::int32_t, 3>;
  struct CellBox {
    Cell least, greatest;
  };
  struct Place {
    bool isOccupied = false;
    int shift = 0;  ///< log2 of the blocks along the edge of the largest cell around that is alike all over.
  };

  void fill(std::uint32_t node, const Cell& origin, int shift, std::span<const CellBox> boxes);
  Place find(const Cell& cell) const;

  std::vector<Node> nodes_;
  int levels_ = 0;
  std::array<std::int64_t, 3> base_{};  ///< Of lattice cell 0, in blocks.
  std::array<double, 3> lower_{}, upper_{};
};

}  // namespace aerosol::grid

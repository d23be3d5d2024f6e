// Active voxels of a grid whose planes need not be parallel in space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/voxel_grid.h"
#include "core/grid/active_tree.h"
#include "core/grid/grid_walk.h"

namespace aerosol::grid {

/// A k-d tree in index space over the blocks of 8^3 voxels in which an interpolation of active voxels is more than
/// background (Yue et al. 2010, "Unbiased, Adaptive Stochastic Sampling for Rendering Inhomogeneous Participating
/// Media"), cut to the box around them. Its planes are brought to the ray as the ray meets them: the structure moves
/// into the ray's space, not the ray into the structure's (Wrenninge et al. 2013). Const.
class KdTree {
 public:
  KdTree() = default;
  KdTree(std::span<const VoxelBox> active, VoxelInterpolation interpolation);

  bool empty() const { return nodes_.empty(); }
  const std::array<double, 3>& lower() const { return lower_; }
  const std::array<double, 3>& upper() const { return upper_; }
  std::uint64_t bytes() const { return nodes_.size() * sizeof(Node); }
  std::size_t nodeCount() const { return nodes_.size(); }

  /// Where the infinite line is in occupied blocks, in front of the eye. Blocks are half-open, so a line along a face
  /// is in the upper one.
  void walk(const LineToGrid& line, IntervalTaker& taker) const;
  /// Whether some occupied block meets a box of index space.
  bool touches(const std::array<double, 3>& least, const std::array<double, 3>& greatest) const;

 private:
  struct Node {
    std::int32_t split = 0;     ///< First voxel of the upper part; of a leaf: whether it is occupied.
    std::uint32_t link = leaf;  ///< Of inner nodes: number of the lower child, which the upper follows, times 4 + axis.

    static constexpr std::uint32_t leaf = 3;
    bool isLeaf() const { return (link & 3u) == leaf; }
    std::size_t axis() const { return link & 3u; }
    std::uint32_t child() const { return link >> 2; }
  };
  class Builder;

  std::vector<Node> nodes_;
  std::array<double, 3> lower_{}, upper_{};
};

}  // namespace aerosol::grid

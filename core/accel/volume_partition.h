// A partition of space made ahead of the render: which volume primitives reach into each region.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/accel/hit.h"
#include "core/base/geometry.h"

namespace aerosol::accel {

/// One primitive to be entered into a partition.
struct PartitionItem {
  VolumeId volume = 0;
  Box<World> box;  ///< Outside of it there is nothing of the volume. An empty box leaves it out.
};

/// Whether there is surely nothing of a volume in a box.
using EmptinessTest = std::function<bool(VolumeId volume, const Box<World>& box)>;

/// Counts of a partition.
struct PartitionStatistics {
  std::uint64_t regions = 0;        ///< Leaves, those without a primitive included.
  std::uint64_t references = 0;     ///< Primitives entered, over all regions.
  std::uint64_t emptied = 0;        ///< References that bounds on density made unnecessary.
  std::uint64_t largestRegion = 0;  ///< Primitives of the region that has most.
  std::uint64_t bytes = 0;
};

/// A kd-tree over boxes. Planes by the surface area heuristic (MacDonald and Booth 1990; Wald and Havran 2006): of all
/// ends of boxes the one with the least expected cost of a random ray. Const after it was built.
class VolumePartition {
 public:
  struct Node {
    float plane = 0;
    std::uint32_t link = 0;  ///< Two bits of axis (3: leaf); index of the upper child, the lower one is the next node;
                             ///< of a leaf its number.
    std::uint32_t axis() const { return link >> 30; }
    std::uint32_t index() const { return link & 0x3fffffffu; }
    bool isLeaf() const { return axis() == 3; }
  };
  static constexpr int maximumDepth = 40;

  VolumePartition() = default;
  /// `isEmpty` may be null.
  VolumePartition(std::span<const PartitionItem> items, const EmptinessTest& isEmpty);

  bool empty() const { return nodes_.empty(); }
  const Box<World>& bounds() const { return bounds_; }
  const Node& node(std::uint32_t index) const { return nodes_[index]; }
  /// The primitives of a leaf, ascending.
  std::span<const VolumeId> volumesOf(const Node& leaf) const {
    const std::uint32_t first = firstOf_[leaf.index()], end = firstOf_[leaf.index() + 1];
    return {volumes_.data() + first, end - first};
  }
  const PartitionStatistics& statistics() const { return statistics_; }

 private:
  friend class PartitionBuilder;

  Box<World> bounds_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> firstOf_;  ///< By leaf, and one more: into `volumes_`.
  std::vector<VolumeId> volumes_;
  PartitionStatistics statistics_;
};

/// How many of the boxes a random line through all of them meets on average (the sum of their surfaces over that of
/// the box around them).
double expectedOverlap(std::span<const Box<World>> boxes);

/// The box made larger by what a traversal in float may be off.
Box<World> withMargin(const Box<World>& box);

}  // namespace aerosol::accel

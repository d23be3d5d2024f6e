// What is known of a medium's coefficients, place by place: an adaptive hierarchy of boxes over its object space.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"
#include "core/volume/coefficients.h"

namespace aerosol::volume {

enum class LeafKind : std::uint8_t {
  bounded,  ///< Coefficients vary below a bound.
  empty,    ///< Proven: neither extinction nor emission.
  uniform,  ///< Proven: the same coefficients at every point.
  inner     ///< No leaf: 64 parts.
};

/// A part of space. 16 bytes.
struct BoundNode {
  float majorant = 0;  ///< Working bound on the largest channel of extinction, > 0 in bounded leaves: of shadow rays.
  float control = 0;   ///< Extinction is nowhere less, in no channel.
  float limit = 0;     ///< The bound that was proven, declared or estimated: of paths. More was not expected.
  std::uint32_t link = 0;  ///< Two bits of kind, two of provenance; first node of the parts, or index of coefficients.

  LeafKind kind() const { return static_cast<LeafKind>(link >> 30); }
  Provenance provenance() const { return static_cast<Provenance>(link >> 28 & 3u); }
  std::uint32_t index() const { return link & 0x0fffffffu; }
  static std::uint32_t makeLink(LeafKind kind, Provenance provenance, std::uint32_t index) {
    return static_cast<std::uint32_t>(kind) << 30 | static_cast<std::uint32_t>(provenance) << 28 | index;
  }
};
static_assert(sizeof(BoundNode) == 16);

/// The smallest and largest values over a part of space, of what trackers do not need at each step.
struct BoundRanges {
  float extinctionLow = 0, extinctionHigh = 0;  ///< Of the smallest and of the largest channel.
  float scatteringHigh = 0;
  float emissionLow = 0, emissionHigh = 0;
};

/// A tree in which every inner node has 4 x 4 x 4 parts, over a box of object space. A lattice place counts the cells
/// of the finest level that there could be. Const after it was built.
///
/// Wide nodes because a lookup costs a dependent load a level: 3 levels are 64 cells a side, an octree needs 6. All
/// parts of a node stand together, 1 kB, x fastest.
class BoundTree {
 public:
  static constexpr int levelBits = 2;                          ///< log2 of the parts of a node along an axis.
  static constexpr int maximumLevels = 5;                      ///< 1024 cells a side.
  static constexpr std::uint32_t parts = 1u << 3 * levelBits;  ///< Of a node.

  Box<Object> domain;
  Transform<World, Object> objectToWorld;
  int levels = 1;                   ///< Of this tree; the lattice has 4^levels cells a side.
  std::vector<BoundNode> nodes;     ///< The first 64 are the parts of the whole domain.
  std::vector<BoundRanges> ranges;  ///< By node.
  std::vector<Coefficients> uniform;
  BoundNode outside;  ///< What holds outside of the domain.

  int cellsPerSide() const { return 1 << levelBits * levels; }

  struct Place {
    const BoundNode* leaf = nullptr;
    int shift = 0;  ///< log2 of the leaf's side in lattice cells.
  };
  /// The leaf that holds a lattice cell; coordinates in [0, cellsPerSide()).
  Place find(std::array<std::int32_t, 3> cell) const {
    int shift = levelBits * (levels - 1);
    const BoundNode* node = nodes.data() + partOf(cell, shift);
    while (node->kind() == LeafKind::inner) {
      shift -= levelBits;
      node = nodes.data() + node->index() + partOf(cell, shift);
    }
    return {node, shift};
  }

 private:
  static std::uint32_t partOf(std::array<std::int32_t, 3> cell, int shift) {
    const auto axis = [&](std::size_t i) { return static_cast<std::uint32_t>(cell[i] >> shift) & 3u; };
    return axis(0) | axis(1) << 2 | axis(2) << 4;
  }
};

}  // namespace aerosol::volume

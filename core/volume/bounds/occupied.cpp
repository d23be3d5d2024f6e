#include "core/volume/bounds/occupied.h"

#include <algorithm>
#include <cmath>

namespace aerosol::volume {

namespace {

/// A part of a tree: which node, at which lattice place, of which size (log2).
struct Part {
  std::uint32_t node = 0;
  std::array<std::int32_t, 3> place{};
  int shift = 0;
};

Part partOf(std::uint32_t first, std::array<std::int32_t, 3> origin, int shift, std::uint32_t i) {
  const std::uint32_t index[] = {i & 3u, i >> 2 & 3u, i >> 4 & 3u};
  Part part{first + i, origin, shift};
  for (std::size_t k = 0; k < 3; ++k) part.place[k] += static_cast<std::int32_t>(index[k]) << shift;
  return part;
}

/// Calls `use(part)` for all leaves that are not empty and for which `wants(part)` holds all the way down; stops where
/// `use` returns false.
template <class Wants, class Use>
bool forOccupied(const BoundTree& tree, std::uint32_t first, std::array<std::int32_t, 3> origin, int shift,
                 const Wants& wants, const Use& use) {
  for (std::uint32_t i = 0; i < BoundTree::parts; ++i) {
    const Part part = partOf(first, origin, shift, i);
    const BoundNode& node = tree.nodes[part.node];
    if (node.kind() == LeafKind::empty || !wants(part)) continue;
    if (node.kind() == LeafKind::inner) {
      if (!forOccupied(tree, node.index(), part.place, shift - BoundTree::levelBits, wants, use)) return false;
    } else if (!use(part)) {
      return false;
    }
  }
  return true;
}

template <class To, class From>
Box<To> mapped(const Transform<To, From>& transform, const std::array<double, 3>& lower,
               const std::array<double, 3>& upper) {
  const Matrix4& m = transform.matrix();
  Box<To> box;
  for (int r = 0; r < 3; ++r) {
    const auto i = static_cast<std::size_t>(r);
    double low = m[i][3], high = m[i][3], size = std::fabs(m[i][3]);
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = m[i][k] * lower[k], b = m[i][k] * upper[k];
      low += std::min(a, b);
      high += std::max(a, b);
      size += std::max(std::fabs(a), std::fabs(b));
    }
    // What rounding in float may move a point by, and the steps in double here.
    const double slack = size * 0x1p-22;
    box.lower[r] = static_cast<float>(low - slack);
    box.upper[r] = static_cast<float>(high + slack);
  }
  return box;
}

std::array<double, 3> corner(const BoundTree& tree, const std::array<std::int32_t, 3>& place) {
  std::array<double, 3> p{};
  for (int r = 0; r < 3; ++r) {
    const auto lower = static_cast<double>(tree.domain.lower[r]), upper = static_cast<double>(tree.domain.upper[r]);
    p[static_cast<std::size_t>(r)] = lower + (upper - lower) * place[static_cast<std::size_t>(r)] / tree.cellsPerSide();
  }
  return p;
}

}  // namespace

Box<World> occupiedBounds(const BoundTree& tree) {
  std::array<std::int32_t, 3> least{tree.cellsPerSide(), tree.cellsPerSide(), tree.cellsPerSide()}, most{};
  forOccupied(
      tree, 0, {}, BoundTree::levelBits * (tree.levels - 1), [](const Part&) { return true; },
      [&](const Part& part) {
        for (std::size_t k = 0; k < 3; ++k) {
          least[k] = std::min(least[k], part.place[k]);
          most[k] = std::max(most[k], part.place[k] + (1 << part.shift));
        }
        return true;
      });
  if (least[0] > most[0]) return {};
  return mapped(tree.objectToWorld, corner(tree, least), corner(tree, most));
}

bool isEmptyIn(const BoundTree& tree, const Box<World>& box) {
  std::array<double, 3> lower{}, upper{};
  for (int r = 0; r < 3; ++r) {
    lower[static_cast<std::size_t>(r)] = static_cast<double>(box.lower[r]);
    upper[static_cast<std::size_t>(r)] = static_cast<double>(box.upper[r]);
  }
  const Box<Object> asked = mapped(tree.objectToWorld.inverse(), lower, upper);
  std::array<double, 3> first{}, last{};
  for (int r = 0; r < 3; ++r) {
    const auto k = static_cast<std::size_t>(r);
    const auto low = static_cast<double>(tree.domain.lower[r]), high = static_cast<double>(tree.domain.upper[r]);
    const double scale = tree.cellsPerSide() / (high - low);
    first[k] = (static_cast<double>(asked.lower[r]) - low) * scale - 1e-3;
    last[k] = (static_cast<double>(asked.upper[r]) - low) * scale + 1e-3;
  }
  const auto meets = [&](const Part& part) {
    for (std::size_t k = 0; k < 3; ++k) {
      // The outermost parts also stand for what rounding moves out of the domain.
      if (part.place[k] > 0 && part.place[k] > last[k]) return false;
      const std::int32_t end = part.place[k] + (1 << part.shift);
      if (end < tree.cellsPerSide() && end < first[k]) return false;
    }
    return true;
  };
  return forOccupied(tree, 0, {}, BoundTree::levelBits * (tree.levels - 1), meets, [](const Part&) { return false; });
}

}  // namespace aerosol::volume

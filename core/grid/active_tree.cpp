#include "core/grid/active_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/grid/voxel_support.h"

namespace aerosol::grid {

namespace {

constexpr int levelBits = 2;
constexpr std::uint32_t childCount = 1u << 3 * levelBits;
constexpr double blockSize = 1 << ActiveTree::blockBits;

std::int32_t clampCell(double x, std::int32_t first, std::int32_t last) {
  if (!(x > static_cast<double>(first))) return first;
  return x < static_cast<double>(last) ? static_cast<std::int32_t>(x) : last;
}

}  // namespace

ActiveTree::ActiveTree(std::span<const VoxelBox> active, VoxelInterpolation interpolation) {
  if (active.empty()) return;
  const VoxelSupport support = supportOf(interpolation);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  lower_ = {infinity, infinity, infinity};
  upper_ = {-infinity, -infinity, -infinity};
  const auto blockOf = [](std::int64_t voxel) { return voxel >> blockBits; };
  std::array<std::int64_t, 3> least{}, greatest{};
  for (std::size_t i = 0; i < active.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      const std::int64_t a = blockOf(std::int64_t{active[i].least[r]} - support.before);
      const std::int64_t b = blockOf(std::int64_t{active[i].greatest[r]} + support.behind);
      least[r] = i == 0 ? a : std::min(least[r], a);
      greatest[r] = i == 0 ? b : std::max(greatest[r], b);
      lower_[r] = std::min(lower_[r], active[i].least[r] - support.reach);
      upper_[r] = std::max(upper_[r], active[i].greatest[r] + support.reach);
    }
  }
  base_ = least;
  levels_ = 1;
  for (std::size_t r = 0; r < 3; ++r) {
    while ((std::int64_t{1} << levelBits * levels_) <= greatest[r] - least[r]) ++levels_;
  }
  std::vector<CellBox> boxes(active.size());
  for (std::size_t i = 0; i < active.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      const auto cell = [&](std::int64_t voxel) { return static_cast<std::int32_t>(blockOf(voxel) - base_[r]); };
      boxes[i].least[r] = cell(std::int64_t{active[i].least[r]} - support.before);
      boxes[i].greatest[r] = cell(std::int64_t{active[i].greatest[r]} + support.behind);
    }
  }
  nodes_.emplace_back();
  fill(0, {}, levelBits * (levels_ - 1), boxes);
}

/// `shift`: log2 of the blocks along a child's edge.
void ActiveTree::fill(std::uint32_t node, const Cell& origin, int shift, std::span<const CellBox> boxes) {
  std::array<std::vector<CellBox>, childCount> parts;
  std::uint64_t wholly = 0;
  const std::int32_t last = (1 << shift) - 1;
  for (const CellBox& box : boxes) {
    Cell from, to;
    for (std::size_t r = 0; r < 3; ++r) {
      from[r] = std::clamp((box.least[r] - origin[r]) >> shift, 0, 3);
      to[r] = std::clamp((box.greatest[r] - origin[r]) >> shift, 0, 3);
    }
    for (std::int32_t z = from[2]; z <= to[2]; ++z) {
      for (std::int32_t y = from[1]; y <= to[1]; ++y) {
        for (std::int32_t x = from[0]; x <= to[0]; ++x) {
          const auto child = static_cast<std::uint32_t>(x | y << 2 | z << 4);
          const Cell begin{origin[0] + (x << shift), origin[1] + (y << shift), origin[2] + (z << shift)};
          bool covers = true;
          for (std::size_t r = 0; r < 3; ++r) {
            covers = covers && box.least[r] <= begin[r] && box.greatest[r] >= begin[r] + last;
          }
          if (covers) {
            wholly |= std::uint64_t{1} << child;
          } else {
            parts[child].push_back(box);
          }
        }
      }
    }
  }
  std::uint64_t partly = 0;
  for (std::uint32_t child = 0; child < childCount; ++child) {
    if (!(wholly >> child & 1) && !parts[child].empty()) partly |= std::uint64_t{1} << child;
  }
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + static_cast<std::size_t>(std::popcount(partly)));
  std::uint32_t next = first;
  for (std::uint64_t rest = partly; rest != 0; rest &= rest - 1) {
    const auto child = static_cast<std::uint32_t>(std::countr_zero(rest));
    const Cell begin{origin[0] + (static_cast<std::int32_t>(child & 3u) << shift),
                     origin[1] + (static_cast<std::int32_t>(child >> 2 & 3u) << shift),
                     origin[2] + (static_cast<std::int32_t>(child >> 4) << shift)};
    fill(next++, begin, shift - levelBits, parts[child]);
  }
  nodes_[node] = {partly, wholly, first};
}

ActiveTree::Place ActiveTree::find(const Cell& cell) const {
  std::uint32_t node = 0;
  for (int shift = levelBits * (levels_ - 1);; shift -= levelBits) {
    const auto part = [&](std::size_t r) { return static_cast<std::uint32_t>(cell[r] >> shift) & 3u; };
    const std::uint64_t bit = std::uint64_t{1} << (part(0) | part(1) << 2 | part(2) << 4);
    const Node& n = nodes_[node];
    if (n.wholly & bit) return {true, shift};
    if (!(n.partly & bit)) return {false, shift};
    node = n.first + static_cast<std::uint32_t>(std::popcount(n.partly & (bit - 1)));
  }
}

void ActiveTree::walk(const std::array<double, 3>& origin, const std::array<double, 3>& direction,
                      IntervalTaker& taker) const {
  if (nodes_.empty()) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::int32_t side = 1 << levelBits * levels_;
  double entry = -infinity, exit = infinity;
  std::array<double, 3> o{}, inverse{};
  std::array<std::int32_t, 3> forward{};
  for (std::size_t r = 0; r < 3; ++r) {
    const auto base = static_cast<double>(base_[r]);
    o[r] = origin[r] / blockSize - base;
    inverse[r] = blockSize / direction[r];
    forward[r] = direction[r] >= 0;
    if (direction[r] == 0) {
      if (origin[r] < lower_[r] || origin[r] >= upper_[r]) return;
      continue;
    }
    const double a = (lower_[r] - origin[r]) / direction[r], b = (upper_[r] - origin[r]) / direction[r];
    entry = std::max(entry, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  if (!(entry < exit)) return;
  const auto place = [&](std::size_t r, double t) { return o[r] + t * (direction[r] / blockSize); };
  Cell cell;
  for (std::size_t r = 0; r < 3; ++r) {
    cell[r] = clampCell(direction[r] == 0 ? o[r] : place(r, entry), 0, side - 1);
  }
  double t = entry, begin = entry;
  bool isInside = false;
  while (t < exit) {
    const Place here = find(cell);
    if (here.isOccupied != isInside) {
      if (isInside && begin < t) taker.add(begin, t);
      begin = t;
      isInside = here.isOccupied;
    }
    double nearest = infinity;
    std::size_t axis = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      if (direction[r] == 0) continue;
      const double face = static_cast<double>(((cell[r] >> here.shift) + forward[r]) << here.shift);
      const double leaves = (face - o[r]) * inverse[r];
      if (leaves < nearest) {
        nearest = leaves;
        axis = r;
      }
    }
    t = std::min(std::max(t, nearest), exit);
    for (std::size_t r = 0; r < 3; ++r) {
      const std::int32_t first = (cell[r] >> here.shift) << here.shift, last = first + (1 << here.shift) - 1;
      if (r == axis) {
        cell[r] = forward[r] ? last + 1 : first - 1;
      } else {
        cell[r] = clampCell(direction[r] == 0 ? o[r] : place(r, t), first, last);
      }
    }
    if (cell[axis] < 0 || cell[axis] >= side) break;
  }
  if (isInside && begin < t) taker.add(begin, t);
}

}  // namespace aerosol::grid

#include "core/grid/kd_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/grid/voxel_support.h"

namespace aerosol::grid {

namespace {

constexpr int blockBits = ActiveTree::blockBits;
/// So many splits that follow the cost; below them cells are halved.
constexpr int freeDepth = 40;
constexpr int stackSize = 160;
/// A tile with more blocks than this is not taken apart.
constexpr std::int64_t mostBlocksOfTile = 4096;

}  // namespace

/// Splits by the surface area heuristic: the cost of a part is its surface times a price, 0 for one without blocks, 1
/// for one that is full, more for others.
class KdTree::Builder {
 public:
  using Cell = std::array<std::int32_t, 3>;
  struct Cells {
    Cell first{}, last{};  ///< Both included.

    double volume() const {
      return static_cast<double>(last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
    }
    double surface() const {
      const double x = last[0] - first[0] + 1, y = last[1] - first[1] + 1, z = last[2] - first[2] + 1;
      return x * y + y * z + z * x;
    }
  };

  Builder(std::vector<Node>& nodes, std::vector<Cell> blocks, std::vector<Cells> tiles)
      : nodes_(nodes), blocks_(std::move(blocks)), tiles_(std::move(tiles)) {}

  void build(const Cells& all) {
    nodes_.emplace_back();
    split(0, all, blocks_, tiles_, 0);
  }

 private:
  void split(std::uint32_t node, const Cells& cells, std::span<Cell> blocks, std::span<const Cells> tiles, int depth) {
    const bool isFull = std::ranges::any_of(tiles, [&](const Cells& tile) { return covers(tile, cells); }) ||
                        static_cast<double>(blocks.size()) == cells.volume();
    if (isFull || (blocks.empty() && tiles.empty())) {
      nodes_[node] = {isFull ? 1 : 0, Node::leaf};
      return;
    }
    const auto [axis, position] = depth < freeDepth ? cheapest(cells, blocks, tiles) : middle(cells);
    Cells below = cells, above = cells;
    below.last[axis] = position - 1;
    above.first[axis] = position;
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[node] = {position << blockBits, child << 2 | static_cast<std::uint32_t>(axis)};
    const auto rest = std::ranges::partition(blocks, [&](const Cell& c) { return c[axis] < position; });
    const auto count = static_cast<std::size_t>(rest.begin() - blocks.begin());
    split(child, below, blocks.first(count), within(tiles, below), depth + 1);
    split(child + 1, above, blocks.subspan(count), within(tiles, above), depth + 1);
  }

  static bool covers(const Cells& a, const Cells& b) {
    bool result = true;
    for (std::size_t r = 0; r < 3; ++r) result = result && a.first[r] <= b.first[r] && a.last[r] >= b.last[r];
    return result;
  }

  static std::vector<Cells> within(std::span<const Cells> tiles, const Cells& cells) {
    std::vector<Cells> result;
    for (Cells tile : tiles) {
      bool meets = true;
      for (std::size_t r = 0; r < 3; ++r) {
        tile.first[r] = std::max(tile.first[r], cells.first[r]);
        tile.last[r] = std::min(tile.last[r], cells.last[r]);
        meets = meets && tile.first[r] <= tile.last[r];
      }
      if (meets) result.push_back(tile);
    }
    return result;
  }

  static std::pair<std::size_t, std::int32_t> middle(const Cells& cells) {
    std::size_t axis = 0;
    for (std::size_t r = 1; r < 3; ++r) {
      if (cells.last[r] - cells.first[r] > cells.last[axis] - cells.first[axis]) axis = r;
    }
    return {axis, cells.first[axis] + (cells.last[axis] - cells.first[axis] + 1) / 2};
  }

  static double cost(const Cells& cells, double count) {
    if (count == 0) return 0;
    const double price = count >= cells.volume() ? 1 : 2 + std::log2(1 + std::min(count, cells.volume() - count));
    return cells.surface() * price;
  }

  static std::pair<std::size_t, std::int32_t> cheapest(const Cells& cells, std::span<const Cell> blocks,
                                                       std::span<const Cells> tiles) {
    auto best = middle(cells);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < 3; ++r) {
      const auto size = static_cast<std::size_t>(cells.last[r] - cells.first[r] + 1);
      std::vector<double> slices(size);
      const auto slice = [&](std::int32_t place) -> double& {
        return slices[static_cast<std::size_t>(place - cells.first[r])];
      };
      for (const Cell& block : blocks) ++slice(block[r]);
      double total = static_cast<double>(blocks.size());
      for (const Cells& tile : tiles) {
        const double thickness = tile.last[r] - tile.first[r] + 1;
        for (std::int32_t i = tile.first[r]; i <= tile.last[r]; ++i) slice(i) += tile.volume() / thickness;
        total += tile.volume();
      }
      double count = 0;
      Cells below = cells, above = cells;
      for (std::int32_t position = cells.first[r] + 1; position <= cells.last[r]; ++position) {
        count += slice(position - 1);
        below.last[r] = position - 1;
        above.first[r] = position;
        const double price = cost(below, count) + cost(above, total - count);
        if (price < least) {
          least = price;
          best = {r, position};
        }
      }
    }
    return best;
  }

  std::vector<Node>& nodes_;
  std::vector<Cell> blocks_;
  std::vector<Cells> tiles_;
};

KdTree::KdTree(std::span<const VoxelBox> active, VoxelInterpolation interpolation) {
  if (active.empty()) return;
  const VoxelSupport support = supportOf(interpolation);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  lower_ = {infinity, infinity, infinity};
  upper_ = {-infinity, -infinity, -infinity};
  std::vector<Builder::Cell> blocks;
  std::vector<Builder::Cells> tiles;
  Builder::Cells all;
  for (std::size_t i = 0; i < active.size(); ++i) {
    Builder::Cells cells;
    for (std::size_t r = 0; r < 3; ++r) {
      const auto blockOf = [](std::int64_t voxel) { return static_cast<std::int32_t>(voxel >> blockBits); };
      cells.first[r] = blockOf(std::int64_t{active[i].least[r]} - support.before);
      cells.last[r] = blockOf(std::int64_t{active[i].greatest[r]} + support.behind);
      all.first[r] = i == 0 ? cells.first[r] : std::min(all.first[r], cells.first[r]);
      all.last[r] = i == 0 ? cells.last[r] : std::max(all.last[r], cells.last[r]);
      lower_[r] = std::min(lower_[r], active[i].least[r] - support.reach);
      upper_[r] = std::max(upper_[r], active[i].greatest[r] + support.reach);
    }
    if (cells.volume() > static_cast<double>(mostBlocksOfTile)) {
      tiles.push_back(cells);
      continue;
    }
    for (std::int32_t x = cells.first[0]; x <= cells.last[0]; ++x) {
      for (std::int32_t y = cells.first[1]; y <= cells.last[1]; ++y) {
        for (std::int32_t z = cells.first[2]; z <= cells.last[2]; ++z) blocks.push_back({x, y, z});
      }
    }
  }
  std::ranges::sort(blocks);
  blocks.erase(std::ranges::unique(blocks).begin(), blocks.end());
  Builder(nodes_, std::move(blocks), std::move(tiles)).build(all);
}

namespace {

/// Ascending intervals; those that touch become one.
class Joiner {
 public:
  explicit Joiner(IntervalTaker& taker) : taker_(taker) {}
  void add(double t0, double t1) {
    if (!(t0 < t1)) return;
    if (isOpen_ && t0 <= end_) {
      end_ = std::max(end_, t1);
      return;
    }
    finish();
    begin_ = t0;
    end_ = t1;
    isOpen_ = true;
  }
  void finish() {
    if (isOpen_) taker_.add(begin_, end_);
    isOpen_ = false;
  }

 private:
  IntervalTaker& taker_;
  double begin_ = 0, end_ = 0;
  bool isOpen_ = false;
};

/// Cuts [t0, t1] to where value + slope t is positive; where it is 0 too for `closed`.
void clip(double value, double slope, bool closed, double& t0, double& t1) {
  if (slope == 0) {
    if (closed ? value < 0 : value <= 0) t1 = -std::numeric_limits<double>::infinity();
    return;
  }
  const double root = -value / slope;
  (slope > 0 ? t0 : t1) = slope > 0 ? std::max(t0, root) : std::min(t1, root);
}

}  // namespace

void KdTree::walk(const LineToGrid& line, IntervalTaker& taker) const {
  if (nodes_.empty()) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double t0 = -infinity, t1 = infinity;
  for (std::size_t r = 0; r < 3; ++r) {
    clip(line.c[r], line.d[r], false, t0, t1);
    clip(line.a[r] - lower_[r] * line.c[r], line.b[r] - lower_[r] * line.d[r], true, t0, t1);
    clip(upper_[r] * line.c[r] - line.a[r], upper_[r] * line.d[r] - line.b[r], false, t0, t1);
  }
  if (!(t0 < t1)) return;
  struct Part {
    std::uint32_t node;
    double t0, t1;
  };
  std::array<Part, stackSize> stack;
  std::size_t size = 0;
  Joiner joiner(taker);
  Part part{0, t0, t1};
  for (;;) {
    const Node& node = nodes_[part.node];
    if (!node.isLeaf()) {
      const std::size_t r = node.axis();
      const double c = node.split;
      const double value = line.a[r] - c * line.c[r], slope = line.b[r] - c * line.d[r];
      const std::uint32_t below = node.child(), above = below + 1;
      if (slope == 0) {
        part.node = value >= 0 ? above : below;
        continue;
      }
      const double root = -value / slope;
      const std::uint32_t first = slope > 0 ? below : above, second = slope > 0 ? above : below;
      if (root <= part.t0) {
        part.node = second;
      } else if (root >= part.t1) {
        part.node = first;
      } else {
        stack[size++] = {second, root, part.t1};
        part = {first, part.t0, root};
      }
      continue;
    }
    if (node.split != 0) joiner.add(part.t0, part.t1);
    if (size == 0) break;
    part = stack[--size];
  }
  joiner.finish();
}

bool KdTree::touches(const std::array<double, 3>& least, const std::array<double, 3>& greatest) const {
  if (nodes_.empty()) return false;
  for (std::size_t r = 0; r < 3; ++r) {
    if (greatest[r] < lower_[r] || least[r] > upper_[r]) return false;
  }
  std::vector<std::uint32_t> rest{0};
  while (!rest.empty()) {
    const Node& node = nodes_[rest.back()];
    rest.pop_back();
    if (node.isLeaf()) {
      if (node.split != 0) return true;
      continue;
    }
    if (least[node.axis()] <= node.split) rest.push_back(node.child());
    if (greatest[node.axis()] >= node.split) rest.push_back(node.child() + 1);
  }
  return false;
}

}  // namespace aerosol::grid

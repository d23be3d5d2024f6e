#include "core/accel/volume_partition.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace aerosol::accel {

namespace {

double surfaceOf(const Box<World>& box) {
  if (box.isEmpty()) return 0;
  const auto side = [&](int i) { return static_cast<double>(box.upper[i]) - static_cast<double>(box.lower[i]); };
  return side(0) * side(1) + side(1) * side(2) + side(2) * side(0);
}

Box<World> intersection(const Box<World>& a, const Box<World>& b) {
  Box<World> box;
  for (int i = 0; i < 3; ++i) {
    box.lower[i] = std::max(a.lower[i], b.lower[i]);
    box.upper[i] = std::min(a.upper[i], b.upper[i]);
  }
  return box;
}

}  // namespace

Box<World> withMargin(const Box<World>& box) {
  Box<World> larger;
  for (int i = 0; i < 3; ++i) {
    const float pad = 1e-6f * std::max({std::fabs(box.lower[i]), std::fabs(box.upper[i]), 1e-30f});
    larger.lower[i] = box.lower[i] - pad;
    larger.upper[i] = box.upper[i] + pad;
  }
  return larger;
}

double expectedOverlap(std::span<const Box<World>> boxes) {
  Box<World> all;
  double sum = 0;
  for (const Box<World>& box : boxes) {
    if (box.isEmpty()) continue;
    all.extend(box.lower);
    all.extend(box.upper);
    sum += surfaceOf(box);
  }
  const double whole = surfaceOf(all);
  return whole > 0 ? sum / whole : static_cast<double>(boxes.size());
}

/// Builds top-down. Costs are in units of a step to a child; testing a primitive's exact shape costs several of them.
class PartitionBuilder {
 public:
  PartitionBuilder(VolumePartition& partition, std::span<const PartitionItem> items, const EmptinessTest& isEmpty)
      : partition_(partition), isEmpty_(isEmpty) {
    for (const PartitionItem& item : items) {
      if (item.box.isEmpty()) continue;
      items_.push_back({item.volume, withMargin(item.box)});
      partition_.bounds_.extend(items_.back().box.lower);
      partition_.bounds_.extend(items_.back().box.upper);
    }
    if (items_.empty()) return;
    const auto depth = static_cast<int>(8 + 1.3 * std::log2(static_cast<double>(items_.size())));
    std::vector<std::uint32_t> all(items_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    partition_.firstOf_.push_back(0);
    build(partition_.bounds_, all, std::min(depth, VolumePartition::maximumDepth - 1), 0);
    PartitionStatistics& s = partition_.statistics_;
    s.references = partition_.volumes_.size();
    s.bytes = partition_.nodes_.size() * sizeof(VolumePartition::Node) +
              partition_.firstOf_.size() * sizeof(std::uint32_t) + partition_.volumes_.size() * sizeof(VolumeId);
  }

 private:
  struct Plane {
    int axis = 3;
    float place = 0;
    double cost = 0;
  };

  static constexpr double testCost = 6;
  static constexpr double emptyBonus = 0.5;
  static constexpr int largestWaste = 3;  ///< Splits in a row that do not pay by themselves.

  /// The cheapest plane along one axis: a sweep over the sorted ends of the boxes.
  void sweep(const Box<World>& region, std::span<const std::uint32_t> items, int axis, Plane& best) {
    ends_.clear();
    for (const std::uint32_t i : items) {
      ends_.push_back({std::max(items_[i].box.lower[axis], region.lower[axis]), false});
      ends_.push_back({std::min(items_[i].box.upper[axis], region.upper[axis]), true});
    }
    std::ranges::sort(ends_);
    const double whole = surfaceOf(region);
    std::size_t below = 0, above = items.size();
    for (std::size_t k = 0; k < ends_.size();) {
      // A box that ends at the plane still is above it for rays within the plane: boxes are closed.
      const float place = ends_[k].place;
      std::size_t starting = 0, ending = 0;
      for (; k < ends_.size() && ends_[k].place == place; ++k) ends_[k].isUpper ? ++ending : ++starting;
      if (place > region.lower[axis] && place < region.upper[axis]) {
        Box<World> lower = region, upper = region;
        lower.upper[axis] = upper.lower[axis] = place;
        const std::size_t countBelow = below + starting, countAbove = above;
        const double bonus = countBelow == 0 || countAbove == 0 ? emptyBonus : 0;
        const double cost = 1 + testCost * (1 - bonus) *
                                    (surfaceOf(lower) * static_cast<double>(countBelow) +
                                     surfaceOf(upper) * static_cast<double>(countAbove)) /
                                    whole;
        if (cost < best.cost) best = {axis, place, cost};
      }
      below += starting;
      above -= ending;
    }
  }

  void build(const Box<World>& region, std::span<const std::uint32_t> items, int depth, int waste) {
    const double leafCost = testCost * static_cast<double>(items.size());
    Plane best{.cost = std::numeric_limits<double>::infinity()};
    if (depth > 0 && items.size() > 1 && surfaceOf(region) > 0) {
      for (int axis = 0; axis < 3; ++axis) sweep(region, items, axis, best);
    }
    if (best.cost > leafCost) ++waste;
    if (best.axis == 3 || waste > largestWaste || best.cost > 4 * leafCost) return addLeaf(region, items);

    std::vector<std::uint32_t> lower, upper;
    for (const std::uint32_t i : items) {
      if (items_[i].box.lower[best.axis] <= best.place) lower.push_back(i);
      if (items_[i].box.upper[best.axis] >= best.place) upper.push_back(i);
    }
    const std::size_t node = partition_.nodes_.size();
    partition_.nodes_.push_back({best.place, 0});
    Box<World> part = region;
    part.upper[best.axis] = best.place;
    build(part, lower, depth - 1, waste);
    partition_.nodes_[node].link =
        static_cast<std::uint32_t>(best.axis) << 30 | static_cast<std::uint32_t>(partition_.nodes_.size());
    part = region;
    part.lower[best.axis] = best.place;
    build(part, upper, depth - 1, waste);
  }

  void addLeaf(const Box<World>& region, std::span<const std::uint32_t> items) {
    PartitionStatistics& s = partition_.statistics_;
    const std::size_t before = partition_.volumes_.size();
    for (const std::uint32_t i : items) {
      if (isEmpty_ && isEmpty_(items_[i].volume, intersection(region, items_[i].box))) {
        ++s.emptied;
      } else {
        partition_.volumes_.push_back(items_[i].volume);
      }
    }
    std::ranges::sort(partition_.volumes_.begin() + static_cast<std::ptrdiff_t>(before), partition_.volumes_.end());
    s.largestRegion = std::max<std::uint64_t>(s.largestRegion, partition_.volumes_.size() - before);
    partition_.nodes_.push_back({0, 3u << 30 | static_cast<std::uint32_t>(s.regions++)});
    partition_.firstOf_.push_back(static_cast<std::uint32_t>(partition_.volumes_.size()));
  }

  struct End {
    float place = 0;
    bool isUpper = false;
    friend auto operator<=>(const End&, const End&) = default;
  };

  VolumePartition& partition_;
  const EmptinessTest& isEmpty_;
  std::vector<PartitionItem> items_;
  std::vector<End> ends_;
};

VolumePartition::VolumePartition(std::span<const PartitionItem> items, const EmptinessTest& isEmpty) {
  PartitionBuilder(*this, items, isEmpty);
}

}  // namespace aerosol::accel

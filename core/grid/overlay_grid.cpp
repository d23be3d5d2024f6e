#include "core/grid/overlay_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace aerosol::grid {

OverlayGrid::OverlayGrid(const KdTree& blocks, const VoxelMap& map, int resolution) {
  if (blocks.empty()) return;
  std::array<double, 3> upper;
  map.fileBox(blocks.lower(), blocks.upper(), lower_, upper);
  double longest = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    const double slack = 1e-9 * (std::fabs(lower_[r]) + std::fabs(upper[r]));
    lower_[r] -= slack;
    longest = std::max(longest, upper[r] + slack - lower_[r]);
  }
  cellSize_ = longest / std::max(1, resolution);
  std::size_t count = 1;
  for (std::size_t r = 0; r < 3; ++r) {
    size_[r] = std::max(1, static_cast<int>(std::ceil((upper[r] - lower_[r]) / cellSize_ + 1e-6)));
    count *= static_cast<std::size_t>(size_[r]);
  }
  bits_.assign((count + 63) / 64, 0);
  std::array<int, 3> cell;
  for (cell[2] = 0; cell[2] < size_[2]; ++cell[2]) {
    for (cell[1] = 0; cell[1] < size_[1]; ++cell[1]) {
      for (cell[0] = 0; cell[0] < size_[0]; ++cell[0]) {
        std::array<double, 3> from, to, least, greatest;
        for (std::size_t r = 0; r < 3; ++r) {
          from[r] = lower_[r] + cell[r] * cellSize_;
          to[r] = from[r] + cellSize_;
        }
        // Cells that reach behind the eye may meet anything.
        if (map.indexBox(from, to, least, greatest) && !blocks.touches(least, greatest)) continue;
        const std::size_t n = numberOf(cell);
        bits_[n / 64] |= std::uint64_t{1} << (n % 64);
      }
    }
  }
}

double OverlayGrid::occupied() const {
  std::size_t count = 0;
  for (const std::uint64_t word : bits_) count += static_cast<std::size_t>(std::popcount(word));
  return static_cast<double>(count) / (static_cast<double>(size_[0]) * size_[1] * size_[2]);
}

void OverlayGrid::walk(const std::array<double, 3>& origin, const std::array<double, 3>& direction,
                       IntervalTaker& taker) const {
  if (bits_.empty()) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double t = -infinity, exit = infinity;
  for (std::size_t r = 0; r < 3; ++r) {
    const double upper = lower_[r] + size_[r] * cellSize_;
    if (direction[r] == 0) {
      if (origin[r] < lower_[r] || origin[r] >= upper) return;
      continue;
    }
    const double a = (lower_[r] - origin[r]) / direction[r], b = (upper - origin[r]) / direction[r];
    t = std::max(t, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  if (!(t < exit)) return;
  std::array<int, 3> cell, step;
  std::array<double, 3> next;
  const auto faceAt = [&](std::size_t r, int face) {
    return (lower_[r] + face * cellSize_ - origin[r]) / direction[r];
  };
  for (std::size_t r = 0; r < 3; ++r) {
    const double place = (origin[r] + (direction[r] == 0 ? 0 : t * direction[r]) - lower_[r]) / cellSize_;
    cell[r] = static_cast<int>(std::clamp(place, 0.0, static_cast<double>(size_[r] - 1)));
    step[r] = direction[r] > 0 ? 1 : -1;
    next[r] = direction[r] == 0 ? infinity : faceAt(r, cell[r] + (step[r] > 0 ? 1 : 0));
  }
  double begin = t;
  bool isInside = false;
  for (;;) {
    const bool now = isOccupied(cell);
    if (now != isInside) {
      if (isInside && begin < t) taker.add(begin, t);
      begin = t;
      isInside = now;
    }
    const auto axis = static_cast<std::size_t>(std::ranges::min_element(next) - next.begin());
    t = std::clamp(next[axis], t, exit);
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= size_[axis] || t >= exit) break;
    next[axis] = faceAt(axis, cell[axis] + (step[axis] > 0 ? 1 : 0));
  }
  if (isInside && begin < t) taker.add(begin, t);
}

}  // namespace aerosol::grid

#include "core/render/contribution_map.h"

#include <cmath>
#include <tuple>

namespace aerosol::render {

namespace {

/// Paths that a mean over more of the scene counts for, beside those of a cell.
constexpr double priorPaths = 8;

struct Sum {
  double value = 0, count = 0;
  double mean(double prior) const { return (value + priorPaths * prior) / (count + priorPaths); }
};

}  // namespace

ContributionMap::ContributionMap(std::vector<PilotPath> paths, int width, int height, int filmWidth, int filmHeight)
    : filmWidth_(filmWidth), filmHeight_(filmHeight) {
  std::ranges::sort(paths, {}, [](const PilotPath& p) { return std::tuple(p.y, p.x, p.sample); });
  std::erase_if(paths, [](const PilotPath& p) { return !std::isfinite(p.value); });
  if (paths.empty()) return;
  gatherPicture(paths, width, height);
  gatherPlaces(paths);
}

/// The grid lies around all but the farthest places: what is outside counts for the cells at its border.
void ContributionMap::gatherPlaces(std::span<const PilotPath> paths) {
  std::array<std::vector<float>, 3> coordinates;
  for (const PilotPath& path : paths) {
    for (const PilotVertex& v : path.vertices) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float x = v.place[static_cast<int>(axis)];
        if (std::isfinite(x)) coordinates[axis].push_back(x);
      }
    }
  }
  if (coordinates[0].size() < 16) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<float>& c = coordinates[axis];
    std::ranges::sort(c);
    const std::size_t rest = c.size() / 100;
    const float low = c[rest], high = c[c.size() - 1 - rest];
    origin_[static_cast<int>(axis)] = low;
    scale_[static_cast<int>(axis)] = high > low ? static_cast<float>(cells) / (high - low) : 0.0f;
  }
  places_.assign(static_cast<std::size_t>(cells) * cells * cells, 0.0f);
  std::vector<Sum> fine(places_.size()), wide(static_cast<std::size_t>(coarse) * coarse * coarse);
  Sum all;
  const auto coarseOf = [](std::size_t cell) {
    const std::size_t x = cell % cells, y = cell / cells % cells, z = cell / cells / cells;
    constexpr std::size_t ratio = cells / coarse;
    return x / ratio + coarse * (y / ratio + coarse * (z / ratio));
  };
  for (const PilotPath& path : paths) {
    for (const PilotVertex& v : path.vertices) {
      const auto brought =
          static_cast<double>(std::max(path.value - v.before, 0.0f)) / static_cast<double>(v.throughput);
      if (!(v.throughput > 0) || !std::isfinite(brought)) continue;
      const std::size_t cell = cellOf(v.place);
      for (Sum* sum : {&fine[cell], &wide[coarseOf(cell)], &all}) {
        sum->value += brought;
        sum->count += 1;
      }
    }
  }
  const double mean = all.count > 0 ? all.value / all.count : 0;
  for (std::size_t cell = 0; cell < places_.size(); ++cell) {
    places_[cell] = static_cast<float>(fine[cell].mean(wide[coarseOf(cell)].mean(mean)));
  }
}

void ContributionMap::gatherPicture(std::span<const PilotPath> paths, int width, int height) {
  std::array<Sum, static_cast<std::size_t>(blocks) * blocks> sums;
  Sum all;
  for (const PilotPath& path : paths) {
    const auto block = static_cast<std::size_t>(path.y * blocks / height * blocks + path.x * blocks / width);
    for (Sum* sum : {&sums[block], &all}) {
      sum->value += static_cast<double>(std::fabs(path.value));
      sum->count += 1;
    }
  }
  // What is dark beside what is bright need not be exact.
  const double mean = all.value / all.count;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    picture_[i] = static_cast<float>(std::max({sums[i].mean(mean), 0.1 * mean, 1e-30}));
  }
}

std::size_t ContributionMap::cellOf(Point<World> place) const {
  std::size_t index = 0;
  for (const int axis : {2, 1, 0}) {
    const float x = (place[axis] - origin_[axis]) * scale_[axis];
    // NaN counts as 0.
    const int cell = x > 0 ? static_cast<int>(std::min(x, static_cast<float>(cells - 1))) : 0;
    index = index * cells + static_cast<std::size_t>(cell);
  }
  return index;
}

float ContributionMap::pixel(int x, int y) const {
  const int column = std::clamp(x * blocks / filmWidth_, 0, blocks - 1);
  const int row = std::clamp(y * blocks / filmHeight_, 0, blocks - 1);
  return picture_[static_cast<std::size_t>(row * blocks + column)];
}

}  // namespace aerosol::render

// Intervals of voxels in a frustum: a k-d tree over their blocks whose planes are carried to the ray (Wrenninge et al.
// 2013), and a regular grid laid over them (Museth 2014). Time a line, memory, and what padding adds to the intervals.
// Voxels as in the talk: 874 x 409 x 85, those of a cloudy ball being active; lines from the camera, and from anywhere.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "core/grid/overlay_grid.h"
#include "tests/bench/places/tables.h"

namespace aerosol::bench {

namespace {

constexpr std::array<int, 3> size{874, 409, 85};

constexpr double near = 4, far = 12, width = 6;

/// What a camera at the origin sees along z, from 4 to 12: in even steps of depth, or of 1 / depth.
VoxelMap linearDepth() {
  const Matrix4 fromFile = {{{1 / width, 0, 0, 0}, {0, 1 / width, 0, 0}, {0, 0, 1, -near}, {0, 0, 0, 1}}};
  return VoxelMap::linearDepth({-0.5, -0.5, -0.5}, {size[0] - 0.5, size[1] - 0.5, size[2] - 0.5}, near / far,
                               far - near, fromFile);
}
VoxelMap projective() {
  const double x = far * size[0] / width, y = far * size[1] / width, z = size[2] / (1 - near / far);
  return VoxelMap::projective({{{x, 0, size[0] / 2.0 - 0.5, 0},
                                {0, y * size[0] / size[1], size[1] / 2.0 - 0.5, 0},
                                {0, 0, z - 0.5, -z * near},
                                {0, 0, 1, 0}}});
}

grid::KdTree blocksOf(const VoxelMap& map) {
  std::vector<VoxelBox> boxes;
  for (int x = 0; x < size[0]; x += 8) {
    for (int y = 0; y < size[1]; y += 8) {
      for (int z = 0; z < size[2]; z += 8) {
        const auto p = map.toFile({x + 3.5, y + 3.5, z + 3.5});
        if (!p) continue;
        const double r = std::hypot((*p)[0], 2 * (*p)[1], (*p)[2] - 8) / 3;
        const double bumps = 0.4 * std::sin(4 * (*p)[0]) * std::sin(5 * (*p)[1]) * std::sin(3 * (*p)[2]);
        if (r + bumps < 1) boxes.push_back({{x, y, z}, {x + 7, y + 7, z + 7}});
      }
    }
  }
  return grid::KdTree(boxes, VoxelInterpolation::trilinear);
}

struct Line {
  std::array<double, 3> origin, direction;
};

const std::vector<Line>& lines(bool fromCamera) {
  static const auto make = [](bool camera) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Line> all(4096);
    for (Line& line : all) {
      const std::array<double, 3> target{3 * uniform(random), 1.5 * uniform(random), 8 + 3 * uniform(random)};
      line.origin =
          camera ? std::array<double, 3>{} : std::array<double, 3>{9 * uniform(random), 9 * uniform(random), 9};
      for (std::size_t r = 0; r < 3; ++r) line.direction[r] = target[r] - line.origin[r];
    }
    return all;
  };
  static const std::vector<Line> seen = make(true), any = make(false);
  return fromCamera ? seen : any;
}

class Found final : public grid::IntervalTaker {
 public:
  void add(double t0, double t1) override {
    length += t1 - t0;
    ++count;
  }
  double length = 0;
  std::int64_t count = 0;
};

void print(const char* name, double seconds, const Found& found, double exact, std::uint64_t bytes) {
  const double count = static_cast<double>(lines(true).size());
  fmt::print("    {:<24}{:>10.0f}{:>16.2f}{:>12.2f}{:>12.3f}\n", name, 1e9 * seconds / count,
             1e-6 * static_cast<double>(found.count) / seconds, 1e-6 * static_cast<double>(bytes),
             found.length / exact);
}

void compare(const char* name, const VoxelMap& map) {
  const grid::KdTree blocks = blocksOf(map);
  constexpr std::array cells{16, 32, 64, 128, 256};
  std::vector<grid::OverlayGrid> overlays;
  for (const int each : cells) overlays.emplace_back(blocks, map, each);
  for (const bool fromCamera : {true, false}) {
    fmt::print("  {}, lines {}\n    {:<24}{:>10}{:>16}{:>12}{:>12}\n", name,
               fromCamera ? "from the camera" : "from anywhere", "", "ns a line", "million spans/s", "megabytes",
               "length");
    std::vector<Found> found(1 + overlays.size());
    std::vector<std::function<void()>> works;
    works.emplace_back([&] {
      found[0] = {};
      for (const Line& line : lines(fromCamera))
        blocks.walk(grid::LineToGrid(map, line.origin, line.direction), found[0]);
    });
    for (std::size_t i = 0; i < overlays.size(); ++i) {
      works.emplace_back([&, i] {
        found[i + 1] = {};
        for (const Line& line : lines(fromCamera)) overlays[i].walk(line.origin, line.direction, found[i + 1]);
      });
    }
    const std::vector<double> seconds = medianSeconds(works);
    print("planes of blocks", seconds[0], found[0], found[0].length, blocks.bytes());
    for (std::size_t i = 0; i < overlays.size(); ++i) {
      print(fmt::format("{} cells over them", cells[i]).c_str(), seconds[i + 1], found[i + 1], found[0].length,
            overlays[i].bytes());
    }
  }
}

}  // namespace

void printFrusta() {
  fmt::print("\nVoxels in a frustum ({} x {} x {}); length: of what is found, by what holds voxels\n", size[0], size[1],
             size[2]);
  compare("even steps of depth", linearDepth());
  compare("projective", projective());
}

}  // namespace aerosol::bench

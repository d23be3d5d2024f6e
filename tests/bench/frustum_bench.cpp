// Intervals of voxels in a frustum: a k-d tree over their blocks whose planes are carried to the ray (Wrenninge et al.
// 2013), and a regular grid laid over them (Museth 2014). Time a line, memory, and what padding adds to the intervals.
// Voxels as in the talk: 874 x 409 x 85, those of a cloudy ball being active; lines from the camera, and from anywhere.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "core/grid/overlay_grid.h"

namespace aerosol::bench {

namespace {

constexpr std::array<int, 3> size{874, 409, 85};

VoxelMap map() {
  // What a camera at the origin sees along z, from 4 to 12.
  const double near = 4, far = 12, width = 6;
  const Matrix4 fromFile = {{{1 / width, 0, 0, 0}, {0, 1 / width, 0, 0}, {0, 0, 1, -near}, {0, 0, 0, 1}}};
  return VoxelMap::linearDepth({-0.5, -0.5, -0.5}, {size[0] - 0.5, size[1] - 0.5, size[2] - 0.5}, near / far,
                               far - near, fromFile);
}

const grid::KdTree& blocks() {
  static const grid::KdTree tree = [] {
    std::vector<VoxelBox> boxes;
    const VoxelMap m = map();
    for (int x = 0; x < size[0]; x += 8) {
      for (int y = 0; y < size[1]; y += 8) {
        for (int z = 0; z < size[2]; z += 8) {
          const auto p = m.toFile({x + 3.5, y + 3.5, z + 3.5});
          if (!p) continue;
          const double r = std::hypot((*p)[0], 2 * (*p)[1], (*p)[2] - 8) / 3;
          const double bumps = 0.4 * std::sin(4 * (*p)[0]) * std::sin(5 * (*p)[1]) * std::sin(3 * (*p)[2]);
          if (r + bumps < 1) boxes.push_back({{x, y, z}, {x + 7, y + 7, z + 7}});
        }
      }
    }
    return grid::KdTree(boxes, VoxelInterpolation::trilinear);
  }();
  return tree;
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

class Length final : public grid::IntervalTaker {
 public:
  void add(double t0, double t1) override { sum += t1 - t0; }
  double sum = 0;
};

double exactLength(bool fromCamera) {
  Length exact;
  for (const Line& line : lines(fromCamera)) blocks().walk(grid::LineToGrid(map(), line.origin, line.direction), exact);
  return exact.sum;
}

void planesOfBlocks(benchmark::State& state) {
  const bool fromCamera = state.range(0) != 0;
  const VoxelMap m = map();
  Length found;
  for (auto _ : state) {
    for (const Line& line : lines(fromCamera)) blocks().walk(grid::LineToGrid(m, line.origin, line.direction), found);
  }
  benchmark::DoNotOptimize(found.sum);
  state.SetItemsProcessed(state.iterations() * 4096);
  state.counters["bytes"] = static_cast<double>(blocks().bytes());
  state.counters["length"] = 1;
}
BENCHMARK(planesOfBlocks)->ArgName("camera")->Arg(1)->Arg(0);

void cellsOverThem(benchmark::State& state) {
  const bool fromCamera = state.range(1) != 0;
  const grid::OverlayGrid cells(blocks(), map(), static_cast<int>(state.range(0)));
  Length found;
  for (auto _ : state) {
    for (const Line& line : lines(fromCamera)) cells.walk(line.origin, line.direction, found);
  }
  state.SetItemsProcessed(state.iterations() * 4096);
  state.counters["bytes"] = static_cast<double>(cells.bytes());
  state.counters["length"] = found.sum / static_cast<double>(state.iterations()) / exactLength(fromCamera);
}
BENCHMARK(cellsOverThem)->ArgNames({"cells", "camera"})->ArgsProduct({{16, 32, 64, 128, 256}, {1, 0}});

}  // namespace

}  // namespace aerosol::bench

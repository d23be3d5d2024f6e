// Nanoseconds a lookup of voxel data, beside NanoVDB's own sampler with its cached accessor. The grid is a cloud of
// half a million voxels; points lie along rays that march through it (half a voxel a step), or anywhere in its box.
#include <benchmark/benchmark.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "core/grid/grid_file.h"

namespace aerosol::bench {

namespace {

struct Cloud {
  openvdb::FloatGrid::Ptr open;
  nanovdb::GridHandle<> nano;
  std::shared_ptr<const VoxelFile> ours;
};

const Cloud& cloud() {
  static const Cloud made = [] {
    openvdb::initialize();
    Cloud c;
    c.open = openvdb::FloatGrid::create(0.0f);
    c.open->setTransform(openvdb::math::Transform::createLinearTransform(0.02));
    auto accessor = c.open->getAccessor();
    for (int i = -80; i < 80; ++i) {
      for (int j = -60; j < 60; ++j) {
        for (int k = -80; k < 80; ++k) {
          const double r = std::sqrt(i * i + 1.8 * j * j + k * k) / 75;
          const double value = 1 - r + 0.3 * std::sin(0.31 * i) * std::sin(0.27 * j) * std::sin(0.23 * k);
          if (value > 0) accessor.setValue({i, j, k}, static_cast<float>(value));
        }
      }
    }
    c.nano = nanovdb::openToNanoVDB(*c.open);
    const auto path = std::filesystem::temp_directory_path() / ("aerosol_bench_" + std::to_string(getpid()) + ".vdb");
    openvdb::io::File file(path.string());
    file.write({c.open});
    file.close();
    c.ours = *grid::readGrids(path.string());
    std::filesystem::remove(path);
    return c;
  }();
  return made;
}

struct Points {
  std::vector<float> x, y, z;
};

constexpr std::size_t pointCount = 65536;

const Points& points(bool alongRays) {
  static const auto make = [](bool rays) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1.5f, 1.5f);
    Points p;
    float at[3] = {}, step[3] = {};
    for (std::size_t i = 0; i < pointCount; ++i) {
      if (!rays || i % 256 == 0) {
        for (float& a : at) a = uniform(random);
        float length = 0;
        for (float& s : step) s = uniform(random), length += s * s;
        for (float& s : step) s *= 0.01f / std::sqrt(length);
      }
      p.x.push_back(at[0]);
      p.y.push_back(at[1]);
      p.z.push_back(at[2]);
      for (int r = 0; r < 3; ++r) at[r] += step[r];
    }
    return p;
  };
  static const Points anywhere = make(false), along = make(true);
  return alongRays ? along : anywhere;
}

void nanoTrilinear(benchmark::State& state, bool alongRays) {
  const Points& p = points(alongRays);
  const auto* grid = cloud().nano.grid<float>();
  auto accessor = grid->getAccessor();
  const auto sampler = nanovdb::createSampler<1>(accessor);
  std::vector<float> results(pointCount);
  for (auto _ : state) {
    for (std::size_t i = 0; i < pointCount; ++i)
      results[i] = sampler(grid->worldToIndexF(nanovdb::Vec3f(p.x[i], p.y[i], p.z[i])));
    benchmark::DoNotOptimize(results.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pointCount));
}

void ours(benchmark::State& state, VoxelInterpolation interpolation, bool alongRays) {
  const Points& p = points(alongRays);
  const VoxelGrid& grid = *cloud().ours->grids()[0];
  const auto batch = static_cast<std::size_t>(state.range(0));
  std::vector<float> results(pointCount);
  for (auto _ : state) {
    for (std::size_t i = 0; i < pointCount; i += batch)
      grid.sample(interpolation, batch, &p.x[i], &p.y[i], &p.z[i], &results[i]);
    benchmark::DoNotOptimize(results.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pointCount));
}

BENCHMARK_CAPTURE(nanoTrilinear, alongRays, true);
BENCHMARK_CAPTURE(ours, trilinear_alongRays, VoxelInterpolation::trilinear, true)->Arg(16)->Arg(1024);
BENCHMARK_CAPTURE(nanoTrilinear, anywhere, false);
BENCHMARK_CAPTURE(ours, trilinear_anywhere, VoxelInterpolation::trilinear, false)->Arg(16)->Arg(1024);
BENCHMARK_CAPTURE(ours, nearest_anywhere, VoxelInterpolation::nearest, false)->Arg(16);
BENCHMARK_CAPTURE(ours, tricubic_anywhere, VoxelInterpolation::tricubic, false)->Arg(16);

}  // namespace

}  // namespace aerosol::bench

// Time of a lookup of voxel data beside NanoVDB's own sampler with its cached accessor, and of voxels in time beside
// the same one point by point. The grid is a cloud of half a million voxels; points lie along rays that march through
// it (half a voxel a step), or anywhere in its box.
#include <fmt/format.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "core/grid/grid_file.h"
#include "core/grid/temporal_file.h"
#include "tests/bench/places/tables.h"

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
  std::vector<float> x, y, z, times;
};

constexpr std::size_t pointCount = 65536;

const Points& points(bool alongRays) {
  static const auto make = [](bool rays) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1.5f, 1.5f);
    Points p;
    float at[3] = {}, step[3] = {}, time = 0;
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
      if (!rays || i % 256 == 0) time = 0.5f + uniform(random) / 3;
      p.times.push_back(time);
      for (int r = 0; r < 3; ++r) at[r] += step[r];
    }
    return p;
  };
  static const Points anywhere = make(false), along = make(true);
  return alongRays ? along : anywhere;
}

/// The cloud's values at five times, as curves: it fades.
std::shared_ptr<const VoxelFile> fading() {
  grid::TemporalCurves curves;
  curves.name = "density";
  curves.indexToFile = cloud().ours->grids()[0]->info().indexToFile;
  curves.times = {0, 0.25f, 0.5f, 0.75f, 1};
  const auto accessor = cloud().open->getConstAccessor();
  for (int x = -88; x < 88; x += 8) {
    for (int y = -64; y < 64; y += 8) {
      for (int z = -88; z < 88; z += 8) {
        grid::TemporalSamples samples{{x, y, z}, {}};
        for (const float time : curves.times) {
          for (int v = 0; v < 512; ++v)
            samples.values.push_back(accessor.getValue({x + v / 64, y + v / 8 % 8, z + v % 8}) * std::exp(-2 * time));
        }
        curves.add(samples, 0.01f);
      }
    }
  }
  const auto path = std::filesystem::temp_directory_path() / ("aerosol_bench_" + std::to_string(getpid()) + ".avt");
  std::shared_ptr<const VoxelFile> file;
  if (!grid::writeTemporal(path.string(), {&curves, 1}).hasErrors()) file = *grid::readGrids(path.string());
  std::filesystem::remove(path);
  return file;
}

std::function<void()> byNanoVdb(const Points& p, std::vector<float>& results) {
  return [&] {
    const auto* grid = cloud().nano.grid<float>();
    auto accessor = grid->getAccessor();
    const auto sampler = nanovdb::createSampler<1>(accessor);
    for (std::size_t i = 0; i < pointCount; ++i)
      results[i] = sampler(grid->worldToIndexF(nanovdb::Vec3f(p.x[i], p.y[i], p.z[i])));
  };
}

std::function<void()> byOurs(const VoxelGrid& grid, const Points& p, VoxelInterpolation interpolation,
                             std::size_t batch, std::vector<float>& results) {
  return [&grid, &p, &results, interpolation, batch] {
    for (std::size_t i = 0; i < pointCount; i += batch)
      grid.sampleAt(interpolation, batch, &p.x[i], &p.y[i], &p.z[i], &p.times[i], &results[i]);
  };
}

void compare(bool alongRays, const VoxelGrid& inTime) {
  const Points& p = points(alongRays);
  std::vector<float> results(pointCount);
  const VoxelGrid& still = *cloud().ours->grids()[0];
  using enum VoxelInterpolation;
  const std::pair<const char*, std::function<void()>> all[] = {
      {"NanoVDB's sampler, trilinear", byNanoVdb(p, results)},
      {"trilinear, 16 at once", byOurs(still, p, trilinear, 16, results)},
      {"trilinear, 1024 at once", byOurs(still, p, trilinear, 1024, results)},
      {"nearest, 16 at once", byOurs(still, p, nearest, 16, results)},
      {"tricubic, 16 at once", byOurs(still, p, tricubic, 16, results)},
      {"in time, trilinear, 1 at once", byOurs(inTime, p, trilinear, 1, results)},
      {"in time, trilinear, 16 at once", byOurs(inTime, p, trilinear, 16, results)},
      {"in time, trilinear, 1024 at once", byOurs(inTime, p, trilinear, 1024, results)},
  };
  std::vector<std::function<void()>> works;
  for (const auto& each : all) works.push_back(each.second);
  const std::vector<double> seconds = medianSeconds(works);
  fmt::print("  {}\n    {:<36}{:>12}{:>20}{:>12}\n", alongRays ? "points along rays" : "points anywhere", "",
             "ns a point", "million lookups/s", "of NanoVDB");
  for (std::size_t i = 0; i < works.size(); ++i) {
    const double one = seconds[i] / static_cast<double>(pointCount);
    fmt::print("    {:<36}{:>12.2f}{:>20.1f}{:>11.2f}x\n", all[i].first, 1e9 * one, 1e-6 / one,
               seconds[0] / seconds[i]);
  }
}

}  // namespace

void printLookups() {
  const auto inTime = fading();
  const VoxelGridInfo& still = cloud().ours->grids()[0]->info();
  const VoxelGridInfo& changing = inTime->grids()[0]->info();
  const auto perVoxel = [&](std::uint64_t bytes, std::uint64_t active) {
    return static_cast<double>(bytes) / static_cast<double>(active);
  };
  fmt::print(
      "\nLookups in a cloud of {} active voxels; bytes an active voxel: NanoVDB {:.2f}, with our directory {:.2f}, "
      "as curves at 5 times {:.2f}\n",
      still.activeVoxels, perVoxel(cloud().nano.size(), still.activeVoxels),
      perVoxel(still.memoryBytes, still.activeVoxels), perVoxel(changing.memoryBytes, changing.activeVoxels));
  compare(true, *inTime->grids()[0]);
  compare(false, *inTime->grids()[0]);
}

}  // namespace aerosol::bench

#include "core/app/temporal_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/app/progress.h"
#include "core/app/quantity.h"
#include "core/grid/grid_file.h"
#include "core/image/pending_file.h"

namespace aerosol::app {

namespace {

constexpr std::size_t voxels = 512;

using Files = std::vector<std::shared_ptr<const VoxelFile>>;

/// One grid of every file of a sequence.
class Sequence {
 public:
  Sequence(const VoxelGridInfo& info, const std::vector<float>& times) : info_(info) {
    curves_.name = info.name;
    curves_.channels = info.channels;
    curves_.indexToFile = info.indexToFile;
    curves_.times = times;
  }

  /// What keeps the file's grid from being the next of the sequence; empty when it was added.
  std::string add(const VoxelFile& file) {
    const VoxelGrid* grid = file.find(info_.name);
    if (!grid) return fmt::format("there is no grid '{}', which the first file has", info_.name);
    const VoxelGridInfo& info = grid->info();
    if (!info.problem.empty()) return fmt::format("grid '{}': {}", info.name, info.problem);
    if (info.frustum) return fmt::format("grid '{}' stands in a frustum: a file of curves has no such map", info.name);
    if (info.channels != info_.channels || info.indexToFile != info_.indexToFile)
      return fmt::format("grid '{}' has another type or another map than in the first file", info.name);
    grids_.push_back(grid);
    if (info.isEmpty) return {};
    for (std::size_t i = 0; i < 3; ++i) {
      first_[i] = isEmpty_ ? info.indexBounds[i] : std::min(first_[i], info.indexBounds[i]);
      last_[i] = isEmpty_ ? info.indexBounds[3 + i] : std::max(last_[i], info.indexBounds[3 + i]);
    }
    isEmpty_ = false;
    return {};
  }

  /// Fits the curves of all blocks. `progress` gets the share that is done.
  template <class Progress>
  grid::TemporalCurves fit(float error, const Progress& progress) {
    if (isEmpty_) return curves_;
    for (std::int32_t x = floor8(first_[0]); x <= last_[0]; x += 8) {
      for (std::int32_t y = floor8(first_[1]); y <= last_[1]; y += 8) {
        for (std::int32_t z = floor8(first_[2]); z <= last_[2]; z += 8) addBlock({x, y, z}, error);
      }
      progress(static_cast<double>(x + 8 - floor8(first_[0])) / static_cast<double>(last_[0] + 8 - floor8(first_[0])));
    }
    return curves_;
  }

 private:
  static std::int32_t floor8(std::int32_t i) { return i & ~7; }

  void addBlock(const std::array<std::int32_t, 3>& origin, float error) {
    const auto channels = static_cast<std::size_t>(info_.channels);
    std::array<float, voxels> x, y, z;
    const auto& m = info_.indexToFile;
    for (std::size_t v = 0; v < voxels; ++v) {
      const std::array<double, 3> at{origin[0] + static_cast<double>(v / 64),
                                     origin[1] + static_cast<double>(v / 8 % 8),
                                     origin[2] + static_cast<double>(v % 8)};
      const auto row = [&](std::size_t r) {
        return static_cast<float>(m[4 * r] * at[0] + m[4 * r + 1] * at[1] + m[4 * r + 2] * at[2] + m[4 * r + 3]);
      };
      x[v] = row(0);
      y[v] = row(1);
      z[v] = row(2);
    }
    grid::TemporalSamples samples{origin, std::vector<float>(grids_.size() * channels * voxels)};
    for (std::size_t t = 0; t < grids_.size(); ++t) {
      grids_[t]->sample(VoxelInterpolation::nearest, voxels, x.data(), y.data(), z.data(),
                        samples.values.data() + t * channels * voxels);
    }
    curves_.add(samples, error);
  }

  VoxelGridInfo info_;
  grid::TemporalCurves curves_;
  std::vector<const VoxelGrid*> grids_;
  std::array<std::int32_t, 3> first_{}, last_{};
  bool isEmpty_ = true;
};

}  // namespace

std::vector<grid::TemporalCurves> emptyCurves(const std::vector<grid::NewGrid>& grids,
                                              const std::vector<float>& times) {
  std::vector<grid::TemporalCurves> curves;
  for (const grid::NewGrid& grid : grids) {
    curves.emplace_back();
    curves.back().name = grid.name;
    curves.back().channels = grid.channels;
    curves.back().indexToFile = grid.indexToFile;
    curves.back().times = times;
  }
  return curves;
}

grid::TemporalSamples samplesOf(const render::BakedBlock& block, const grid::NewGrid& grid, std::size_t times) {
  const auto channels = static_cast<std::size_t>(grid.channels);
  grid::TemporalSamples samples{block.origin, std::vector<float>(times * channels * voxels)};
  for (std::size_t t = 0; t < times; ++t) {
    const std::vector<float> values = valuesOf(block, grid, t);
    for (std::size_t v = 0; v < voxels; ++v) {
      for (std::size_t c = 0; c < channels; ++c)
        samples.values[(t * channels + c) * voxels + v] = values[v * channels + c];
    }
  }
  return samples;
}

std::string describeCurves(const std::vector<grid::TemporalCurves>& grids) {
  std::size_t blocks = 0, curves = 0, values = 0;
  for (const grid::TemporalCurves& grid : grids) {
    blocks = std::max(blocks, grid.origins.size());
    curves += static_cast<std::size_t>(std::ranges::count_if(grid.counts, [](std::uint8_t n) { return n > 0; }));
    values += grid.knots.size();
  }
  return fmt::format("{} blocks of 8^3 curves with {:.2f} of {} values on average", blocks,
                     curves > 0 ? static_cast<double>(values) / static_cast<double>(curves) : 0.0,
                     grids.empty() ? 0 : grids.front().times.size());
}

ExitCode joinFrames(const BakeArguments& arguments, const Console& console) {
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  auto output = image::PendingFile::create(arguments.output);
  if (!output) {
    console.report(output.errors());
    return ExitCode::badInput;
  }
  Files files;
  for (const std::string& name : arguments.frames) {
    auto file = grid::readGrids(name);
    if (!file) {
      console.report(file.errors());
      return ExitCode::badInput;
    }
    files.push_back(std::move(*file));
  }
  const std::vector<float> times = arguments.time.times();
  ProgressDisplay display(console);
  std::vector<grid::TemporalCurves> curves;
  const auto grids = files.front()->grids();
  for (std::size_t g = 0; g < grids.size(); ++g) {
    if (grids[g]->info().channels == 0) continue;
    Sequence sequence(grids[g]->info(), times);
    for (std::size_t i = 0; i < files.size(); ++i) {
      const std::string problem = sequence.add(*files[i]);
      if (problem.empty()) continue;
      Diagnostics errors;
      errors.error({arguments.frames[i], 0, 0}, problem);
      console.report(errors);
      return ExitCode::badInput;
    }
    curves.push_back(sequence.fit(arguments.error, [&](double part) {
      if (!arguments.quiet)
        display.show({(static_cast<double>(g) + part) / static_cast<double>(grids.size()), seconds(), 0});
    }));
  }
  display.finish();
  Diagnostics errors = grid::writeTemporal(output->path(), curves);
  if (!errors.hasErrors()) errors = output->commit();
  console.report(errors);
  if (errors.hasErrors()) return ExitCode::badInput;
  if (!arguments.quiet) {
    console.note(
        fmt::format("wrote {}: {}, {}\n", arguments.output, describeCurves(curves), formatDuration(seconds())));
  }
  return ExitCode::success;
}

}  // namespace aerosol::app

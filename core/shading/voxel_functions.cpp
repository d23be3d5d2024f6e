#include "core/shading/voxel_functions.h"

#include <algorithm>
#include <array>
#include <string>

namespace aerosol::shading {

VoxelInterpolation voxelInterpolation(TextureInterpolation interpolation) {
  switch (interpolation) {
    case TextureInterpolation::closest:
      return VoxelInterpolation::nearest;
    case TextureInterpolation::cubic:
      return VoxelInterpolation::tricubic;
    case TextureInterpolation::linear:
    case TextureInterpolation::smartCubic:
      return VoxelInterpolation::trilinear;
  }
  return VoxelInterpolation::trilinear;
}

const VoxelGrid* chooseVoxelGrid(const VoxelFile& file, std::string_view path, const TexturePoint& point,
                                 std::string& problem) {
  const VoxelGrid* grid = nullptr;
  if (point.subimageName.empty() && point.subimage > 0) {
    const auto number = static_cast<std::size_t>(point.subimage);
    if (number < file.grids().size()) grid = file.grids()[number].get();
    if (!grid) problem = "\"" + std::string(path) + "\" has " + std::to_string(file.grids().size()) + " grids";
  } else {
    grid = file.find(point.subimageName);
    if (!grid) {
      problem = "\"" + std::string(path) + "\" has no grid \"" + std::string(point.subimageName) + "\"; it has";
      for (const auto& known : file.grids()) problem += " \"" + known->info().name + "\"";
    }
  }
  if (grid && grid->info().channels == 0) {
    problem = "grid \"" + grid->info().name + "\" of \"" + std::string(path) + "\": " + grid->info().problem;
    grid = nullptr;
  }
  return grid;
}

namespace {

constexpr std::size_t lanes = AEROSOL_MAXIMUM_WIDTH;

/// Values of one grid for some lanes, into the channels that they ask for.
void sampleGrid(TextureCall& call, const VoxelGrid& grid, VoxelInterpolation interpolation,
                std::span<const unsigned> group, std::span<const TexturePoint> points) {
  std::array<float, lanes> x, y, z, times;
  for (std::size_t i = 0; i < group.size(); ++i) {
    x[i] = points[i].at[0];
    y[i] = points[i].at[1];
    z[i] = points[i].at[2];
    times[i] = points[i].time;
  }
  std::array<float, 3 * lanes> values;
  grid.sampleAt(interpolation, group.size(), x.data(), y.data(), z.data(), times.data(), values.data());
  for (std::size_t i = 0; i < group.size(); ++i) {
    std::array<float, maximumTextureChannels> result{};
    for (int c = 0; c < call.channels(); ++c) {
      const std::int64_t channel = std::int64_t{points[i].firstChannel} + c;
      const bool exists = channel >= 0 && channel < grid.info().channels;
      result[static_cast<std::size_t>(c)] =
          exists ? values[static_cast<std::size_t>(channel) * group.size() + i] : points[i].fill;
    }
    call.write(group[i], result.data());
  }
}

}  // namespace

void lookUpVoxels(TextureCall& call, ServicesOfThread& services, std::string_view path,
                  std::span<const unsigned> group) {
  std::string fileProblem;
  const VoxelFile* file = services.voxels(path, fileProblem);
  std::array<TexturePoint, lanes> points;
  std::array<const VoxelGrid*, lanes> grids{};
  for (std::size_t i = 0; i < group.size(); ++i) {
    points[i] = call.read(group[i]);
    std::string problem = fileProblem;
    if (file) grids[i] = chooseVoxelGrid(*file, path, points[i], problem);
    if (grids[i]) continue;
    std::array<float, maximumTextureChannels> result;
    result.fill(points[i].fill);
    if (points[i].hasMissing) {
      std::copy_n(points[i].missing, maximumTextureChannels, result.begin());
    } else {
      call.fail(group[i], problem);
    }
    call.write(group[i], result.data());
  }
  // Lanes that read the same grid in the same way go together.
  for (std::size_t first = 0; first < group.size(); ++first) {
    if (!grids[first]) continue;
    const VoxelGrid& grid = *grids[first];
    const TextureInterpolation interpolation = points[first].interpolation;
    std::array<unsigned, lanes> together{};
    std::array<TexturePoint, lanes> theirs;
    std::size_t count = 0;
    for (std::size_t i = first; i < group.size(); ++i) {
      if (grids[i] != &grid || points[i].interpolation != interpolation) continue;
      together[count] = group[i];
      theirs[count++] = points[i];
      grids[i] = nullptr;
    }
    sampleGrid(call, grid, voxelInterpolation(interpolation), {together.data(), count}, {theirs.data(), count});
  }
}

std::optional<TextureInfo> voxelInfo(ServicesOfThread& services, std::string_view path, std::string_view name,
                                     const TextureInfoType& type) {
  std::string problem;
  const VoxelFile* file = services.voxels(path, problem);
  using Base = TextureInfoType::Base;
  TextureInfo info;
  const auto ints = [&](std::vector<std::int32_t> values) -> std::optional<TextureInfo> {
    const int length = values.size() == 1 ? 0 : static_cast<int>(values.size());
    if (type.base != Base::integer || type.arrayLength != length) return {};
    info.integers = std::move(values);
    return info;
  };
  if (name == "exists") return ints({file ? 1 : 0});
  const VoxelGrid* grid = file ? file->find("") : nullptr;
  if (!file || !grid) return {};
  const VoxelGridInfo& about = grid->info();
  if (name == "subimages") return ints({static_cast<std::int32_t>(file->grids().size())});
  if (name == "channels") return ints({about.channels});
  const auto& box = about.indexBounds;
  if (name == "datawindow" && !about.isEmpty) return ints({box.begin(), box.end()});
  if (name == "resolution" && !about.isEmpty) {
    const auto extent = [&](std::size_t r) {
      return static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{box[3 + r]} - box[r] + 1, INT32_MAX));
    };
    return ints({extent(0), extent(1), extent(2)});
  }
  if (name == "bounds" && !about.isEmpty && type.base == Base::floating && type.arrayLength == 6 && !type.isTriple &&
      !type.isMatrix) {
    for (const double end : about.bounds) info.floats.push_back(static_cast<float>(end));
    return info;
  }
  if ((name == "type" || name == "textureformat") && type.base == Base::string && type.arrayLength == 0) {
    info.strings = {"Volume Texture"};
    return info;
  }
  return {};
}

}  // namespace aerosol::shading

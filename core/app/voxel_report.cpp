#include "core/app/voxel_report.h"

#include <fmt/format.h>

#include <fmt/ranges.h>

#include <filesystem>
#include <span>

namespace aerosol::app {

namespace {

/// "(1, 2, 3)", or "1" for a single channel.
template <class T>
std::string textOf(std::span<const T> values) {
  return values.size() == 1 ? fmt::format("{:g}", values[0]) : fmt::format("({:g})", fmt::join(values, ", "));
}

std::string describeGrid(const VoxelGridInfo& info) {
  std::string text = fmt::format("  \"{}\" {}, {}\n", info.name, info.type, info.purpose);
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("    {:<15}{}\n", name, value);
  };
  line("active voxels", std::to_string(info.activeVoxels));
  if (!info.isEmpty) {
    const std::span box(info.indexBounds);
    line("index bounds", fmt::format("({}) to ({})", fmt::join(box.first(3), ", "), fmt::join(box.last(3), ", ")));
    line("bounds", textOf(std::span<const double>(info.bounds).first(3)) + " to " +
                       textOf(std::span<const double>(info.bounds).last(3)));
  }
  line("voxel size", textOf(std::span<const double>(info.voxelSize)) + (info.frustum ? " in the middle" : ""));
  if (info.frustum) {
    const bool isLinear = info.frustum->denominator[0] != info.frustum->denominator[2];
    line("frustum", isLinear ? "even steps of depth" : "even steps of 1 / depth");
    if (info.frustum->eye) line("eye", textOf(std::span<const double>(*info.frustum->eye)));
  }
  if (!info.problem.empty()) {
    line("cannot be read", info.problem);
    return text;
  }
  const auto channels = static_cast<std::size_t>(info.channels);
  line("background", textOf(std::span<const float>(info.background).first(channels)));
  line("active values", textOf(std::span<const float>(info.least).first(channels)) + " to " +
                            textOf(std::span<const float>(info.greatest).first(channels)));
  line("NaN", std::to_string(info.nanValues));
  line("infinite", std::to_string(info.infiniteValues));
  line("memory", fmt::format("{:.1f} MB", static_cast<double>(info.memoryBytes) / 1e6));
  return text;
}

}  // namespace

std::string describeVoxels(const std::string& path, const VoxelFile& file) {
  const std::string extension = std::filesystem::path(path).extension().string();
  const char* const kind = extension == ".avt"   ? "Voxels in time"
                           : extension == ".vol" ? "Mitsuba volume"
                                                 : "OpenVDB file";
  std::string text = fmt::format("{} \"{}\"\n", kind, path);
  for (const auto& grid : file.grids()) text += describeGrid(grid->info());
  return text;
}

}  // namespace aerosol::app

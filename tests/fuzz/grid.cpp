// Reading a file of voxels from any bytes ends with grids or with an error; it never crashes, and what was read can be
// looked up. The first bytes say which format it is: .vol, .avt, and .vdb where they say nothing.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/grid/grid_file.h"

namespace {

namespace fs = std::filesystem;
using namespace aerosol;

/// Files of this process: fuzzers run side by side.
std::string pathFor(std::string_view bytes) {
  static const fs::path folder = [] {
    std::string name = (fs::temp_directory_path() / "aerosol_fuzz_XXXXXX").string();
    if (!mkdtemp(name.data())) std::abort();
    return fs::path(name);
  }();
  const bool isDense = bytes.starts_with("VOL"), isTemporal = bytes.starts_with("AVT1");
  return (folder / (isDense ? "a.vol" : isTemporal ? "a.avt" : "a.vdb")).string();
}

void lookUp(const VoxelGrid& grid) {
  const VoxelGridInfo& info = grid.info();
  if (!info.problem.empty()) return;
  const float x[] = {0, 1e9f, static_cast<float>(info.bounds[0])},
              y[] = {0.3f, -1e9f, static_cast<float>(info.bounds[1])},
              z[] = {-2, 0, static_cast<float>(info.bounds[2])};
  float results[9];
  for (const auto way : {VoxelInterpolation::nearest, VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
    grid.sample(way, 3, x, y, z, results);
    for (int c = 0; c < info.channels; ++c) grid.range(way, {-1, -1, -1}, {1, 2, 3}, c);
  }
  constexpr std::uint64_t bearable = 1u << 20;
  if (info.activeVoxels < bearable) grid.activeBoxes();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::string path = pathFor(bytes);
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) std::abort();
  std::fclose(file);
  const std::string names[] = {path, path + std::string(grid::unitCubeSuffix), grid::continuedName(path, "v", 2)};
  const auto read = grid::readGrids(names[size % 3]);
  if (!read && format(read.errors()).empty()) std::abort();
  if (!read) return 0;
  for (const auto& each : (*read)->grids()) lookUp(*each);
  return 0;
}

#include "core/grid/grid_file.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "core/base/module.h"
#include "core/base/voxel_file_name.h"
#include "core/grid/module_access.h"
#include "core/grid/temporal_file.h"

namespace aerosol::grid {

namespace {

/// Stands in no name of a file that anybody would give.
constexpr std::string_view continuation = "?continued=";

Result<const ModuleTable*> openTable() {
  const auto module = openModule("aerosol_grid");
  if (!module) return module.errors();
  const auto function = module->function<ModuleTableFunction>(moduleTableName);
  if (!function) return function.errors();
  return (*function)();
}

}  // namespace

const Result<const ModuleTable*>& moduleTable() {
  static const Result<const ModuleTable*> opened = openTable();
  return opened;
}

std::string continuedName(std::string_view path, std::string_view grid, int voxels) {
  return std::string(path) + std::string(continuation) + std::to_string(voxels) + ":" + std::string(grid);
}

std::string_view fileOfName(std::string_view name) {
  return name.substr(0, std::min(name.find(continuation), name.find(unitCubeSuffix)));
}

bool isGridFile(std::string_view name) { return isVoxelFileName(fileOfName(name)); }

Result<std::shared_ptr<const VoxelFile>> readGrids(const std::string& name) {
  const std::string path(fileOfName(name));
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return Diagnostic{Severity::error, {path, 0, 0}, "there is no such file", {}, {}};
  }
  if (isTemporalFile(path)) return readTemporal(path);
  if (!moduleTable()) return moduleTable().errors();
  std::string message;
  std::string grid;
  int voxels = 0;
  const bool isUnit = name.find(unitCubeSuffix, path.size()) != std::string::npos;
  if (path.size() < name.size() && !isUnit) {
    const std::string rest = name.substr(path.size() + continuation.size());
    const std::size_t colon = rest.find(':');
    std::from_chars(rest.data(), rest.data() + colon, voxels);
    grid = rest.substr(colon + 1);
  }
  auto file = (*moduleTable())->read(path, grid, voxels, isUnit, message);
  if (!file) return Diagnostic{Severity::error, {path, 0, 0}, message, {}, {}};
  return std::shared_ptr<const VoxelFile>(std::move(file));
}

Result<std::vector<std::string>> libraryVersions() {
  if (!moduleTable()) return moduleTable().errors();
  return (*moduleTable())->versions();
}

}  // namespace aerosol::grid

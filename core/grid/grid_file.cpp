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
constexpr std::string_view continuation = "?continued=", coarser = "?level=";

/// What stands behind the file's own name, part by part.
VoxelFileName parseName(std::string_view name) {
  VoxelFileName parsed;
  parsed.path = fileOfName(name);
  for (name.remove_prefix(parsed.path.size()); !name.empty();) {
    const std::string_view part = name.substr(0, name.find('?', 1));
    const auto number = [&](std::string_view key, int& value) {
      return std::from_chars(part.data() + key.size(), part.data() + part.size(), value).ptr;
    };
    if (part.starts_with(unitCubeSuffix)) parsed.isUnit = true;
    if (part.starts_with(coarser)) number(coarser, parsed.level);
    if (part.starts_with(continuation)) {
      const char* const colon = number(continuation, parsed.continuedVoxels);
      parsed.continuedGrid.assign(std::min(colon + 1, part.data() + part.size()), part.data() + part.size());
    }
    name.remove_prefix(part.size());
  }
  parsed.level = std::clamp(parsed.level, 0, 10);
  return parsed;
}

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

std::string coarseName(std::string_view path, int level) {
  return std::string(path) + std::string(coarser) + std::to_string(level);
}

std::string_view fileOfName(std::string_view name) {
  return name.substr(0, std::min({name.find(continuation), name.find(unitCubeSuffix), name.find(coarser)}));
}

bool isGridFile(std::string_view name) { return isVoxelFileName(fileOfName(name)); }

Result<std::shared_ptr<const VoxelFile>> readGrids(const std::string& fullName) {
  const VoxelFileName name = parseName(fullName);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(name.path, ignored)) {
    return Diagnostic{Severity::error, {name.path, 0, 0}, "there is no such file", {}, {}};
  }
  if (isTemporalFile(name.path)) return readTemporal(name.path);
  if (!moduleTable()) return moduleTable().errors();
  std::string message;
  auto file = (*moduleTable())->read(name, message);
  if (!file) return Diagnostic{Severity::error, {name.path, 0, 0}, message, {}, {}};
  return std::shared_ptr<const VoxelFile>(std::move(file));
}

Result<std::vector<std::string>> libraryVersions() {
  if (!moduleTable()) return moduleTable().errors();
  return (*moduleTable())->versions();
}

}  // namespace aerosol::grid

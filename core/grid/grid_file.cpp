#include "core/grid/grid_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/base/module.h"
#include "core/grid/module/table.h"

namespace aerosol::grid {

namespace {

Result<const ModuleTable*> openTable() {
  const auto module = openModule("aerosol_grid");
  if (!module) return module.errors();
  const auto function = module->function<ModuleTableFunction>(moduleTableName);
  if (!function) return function.errors();
  return (*function)();
}

/// Opened by the first call.
const Result<const ModuleTable*>& table() {
  static const Result<const ModuleTable*> opened = openTable();
  return opened;
}

}  // namespace

bool isGridFile(std::string_view path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return extension == ".vdb" || extension == ".vol";
}

Result<std::shared_ptr<const VoxelFile>> readGrids(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return Diagnostic{Severity::error, {path, 0, 0}, "there is no such file", {}, {}};
  }
  if (!table()) return table().errors();
  std::string message;
  auto file = (*table())->read(path, message);
  if (!file) return Diagnostic{Severity::error, {path, 0, 0}, message, {}, {}};
  return std::shared_ptr<const VoxelFile>(std::move(file));
}

Result<std::vector<std::string>> libraryVersions() {
  if (!table()) return table().errors();
  return (*table())->versions();
}

}  // namespace aerosol::grid

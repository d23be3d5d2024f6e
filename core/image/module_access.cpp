#include "core/image/module_access.h"

#include "core/base/module.h"

namespace aerosol::image {

namespace {

Result<const ModuleTable*> openTable() {
  const auto module = openModule("aerosol_image");
  if (!module) return module.errors();
  const auto function = module->function<ModuleTableFunction>(moduleTableName);
  if (!function) return function.errors();
  return (*function)();
}

}  // namespace

const Result<const ModuleTable*>& table() {
  static const Result<const ModuleTable*> opened = openTable();
  return opened;
}

}  // namespace aerosol::image

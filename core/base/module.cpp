#include "core/base/module.h"

#include <dlfcn.h>

#include "core/base/paths.h"

namespace aerosol {

namespace {

std::string lastError() {
  const char* text = dlerror();
  return text ? text : "unknown error of the dynamic linker";
}

}  // namespace

Result<Module> Module::open(const std::filesystem::path& file) {
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!handle) {
    return Diagnostic{.location = {.file = file.string()}, .message = "cannot load this module: " + lastError()};
  }
  return Module(handle, file.string());
}

Result<void*> Module::find(const char* name) const {
  dlerror();
  void* address = dlsym(handle_, name);
  if (!address) {
    return Diagnostic{.location = {.file = file_},
                      .message = "this module does not export '" + std::string(name) + "': " + lastError(),
                      .notes = {"the module and the program are not of one build"}};
  }
  return address;
}

Result<Module> openModule(std::string_view name) {
  const auto installation = findInstallation();
  if (!installation) return installation.errors();
  return Module::open(installation->modules / (std::string(name) + ".so"));
}

}  // namespace aerosol

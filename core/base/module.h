// Shared objects that are opened at first use, because loading what they link takes long.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace aerosol {

/// An open shared object. It stays loaded until the process ends: what large libraries leave behind (threads, exit
/// handlers) does not survive being unloaded. Copies refer to the same object.
class Module {
 public:
  /// Opens `file` with its symbols kept to itself; a name without a slash is searched for as the system does. An error
  /// when it, or a library that it needs, cannot be loaded.
  static Result<Module> open(const std::filesystem::path& file);

  /// The function that the module exports in C under `name`; the caller vouches for its type. An error when there is
  /// none.
  template <class Function>
  Result<Function*> function(const char* name) const {
    auto address = find(name);
    if (!address) return address.errors();
    return reinterpret_cast<Function*>(*address);
  }

 private:
  Module(void* handle, std::string file) : handle_(handle), file_(std::move(file)) {}
  Result<void*> find(const char* name) const;

  void* handle_;
  std::string file_;
};

/// Opens the installation's module `name`, such as "aerosol_image".
Result<Module> openModule(std::string_view name);

}  // namespace aerosol

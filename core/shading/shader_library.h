// Shaders by name: the search path, and programs from source or from what the cache knows of the source.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/jit/object_cache.h"
#include "core/lang/compile.h"

namespace aerosol::shading {

/// Not thread-safe: used while a scene is prepared.
class ShaderLibrary {
 public:
  /// Folders are searched in order, each also in its subfolders volume, surface, light and texture. `cache` may be
  /// null.
  ShaderLibrary(std::vector<std::filesystem::path> searchPath, lang::CompileOptions options,
                std::shared_ptr<jit::ObjectCache> cache);

  /// The program of shader NAME.osl, the same object every time. Warnings of its compilation go to `warnings` once.
  /// An error at `use` when no folder has it (with the nearest names that there are), or the errors of the source.
  Result<std::shared_ptr<const lang::Program>> find(const std::string& name, const SourceLocation& use,
                                                    Diagnostics& warnings);

  /// The program of a source file. Messages name the file as it is named here.
  Result<std::shared_ptr<const lang::Program>> load(const std::filesystem::path& file, Diagnostics& warnings);

  /// The program of a source text, for which `name` stands in messages.
  Result<std::shared_ptr<const lang::Program>> compile(const std::string& text, const std::string& name,
                                                       Diagnostics& warnings) const;

  /// Names of all shaders on the search path, sorted.
  std::vector<std::string> names() const;
  const std::vector<std::filesystem::path>& searchPath() const { return searchPath_; }

 private:
  std::vector<std::filesystem::path> folders() const;
  std::string manifestKey(const std::filesystem::path& file, const std::filesystem::path& absolute) const;

  std::vector<std::filesystem::path> searchPath_;
  lang::CompileOptions options_;
  std::shared_ptr<jit::ObjectCache> cache_;
  std::map<std::filesystem::path, std::shared_ptr<const lang::Program>> loaded_;
};

}  // namespace aerosol::shading

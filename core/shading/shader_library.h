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

  /// The program of shader NAME.osl, or of the compiled file NAME.oso beside it when that is not older; the same object
  /// every time. Warnings of its compilation go to `warnings` once.
  /// An error at `use` when no folder has it (with the nearest names that there are), or the errors of the source.
  Result<std::shared_ptr<const lang::Program>> find(const std::string& name, const SourceLocation& use,
                                                    Diagnostics& warnings);

  /// The same shader as a layer of groups.
  Result<std::shared_ptr<const lang::Program>> findLayer(const std::string& name, const SourceLocation& use,
                                                         Diagnostics& warnings);
  /// The same with lengths of arrays that the shader declares without one (array_lengths.h).
  Result<std::shared_ptr<const lang::Program>> findLayer(const std::string& name, const SourceLocation& use,
                                                         Diagnostics& warnings,
                                                         const std::map<std::string, int>& lengths) const;

  /// The program of a source file. Messages name the file as it is named here.
  Result<std::shared_ptr<const lang::Program>> load(const std::filesystem::path& file, Diagnostics& warnings);

  /// The shader of a source file as a layer of groups.
  Result<std::shared_ptr<const lang::Program>> loadLayer(const std::filesystem::path& file, Diagnostics& warnings);

  /// The shader of a text as a layer of groups. `place` is where the text begins, in messages; equal texts at equal
  /// places give the same object.
  Result<std::shared_ptr<const lang::Program>> compileLayer(const std::string& text, const SourceLocation& place,
                                                            Diagnostics& warnings);

  /// The program of a source text, for which `name` stands in messages.
  Result<std::shared_ptr<const lang::Program>> compile(const std::string& text, const std::string& name,
                                                       Diagnostics& warnings) const;

  /// Names of all shaders on the search path, sorted.
  std::vector<std::string> names() const;
  const std::vector<std::filesystem::path>& searchPath() const { return searchPath_; }

 private:
  /// A shader as a program of its own and as a layer.
  struct Shader {
    std::shared_ptr<const lang::Program> program;
    std::shared_ptr<const lang::Program> layer;
  };

  std::vector<std::filesystem::path> folders() const;
  Result<std::filesystem::path> fileOf(const std::string& name, const SourceLocation& use) const;
  Result<Shader> loadShader(const std::filesystem::path& file, Diagnostics& warnings);
  std::string manifestKey(const std::filesystem::path& file, const std::filesystem::path& absolute) const;

  std::vector<std::filesystem::path> searchPath_;
  lang::CompileOptions options_;
  std::shared_ptr<jit::ObjectCache> cache_;
  std::map<std::filesystem::path, Shader> loaded_;
  std::map<std::string, std::shared_ptr<const lang::Program>> texts_;  ///< By place and text.
};

}  // namespace aerosol::shading

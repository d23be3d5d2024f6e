// From OSL source text to programs: the front door of the language layer.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/lang/program.h"

namespace aerosol::lang {

class NativeSource;

struct CompileOptions {
  std::vector<std::filesystem::path> includePaths;  ///< Searched for `#include`, after the including file's folder.
  std::vector<std::string> defines;                 ///< NAME or NAME=VALUE.
  std::vector<std::string> undefines;               ///< Macros that are removed before `defines` count.
  std::filesystem::path standardLibrary;            ///< stdosl.h; empty: the installed one.
  std::shared_ptr<NativeSource> natives;            ///< Plugins; null: there are none.
  bool strict = false;                              ///< Refuses and warns as oslc does, whatever has a meaning here.
  bool advice = true;                               ///< Warnings that oslc does not give: what is unused, hidden, …
};

/// A file that the compilation looked at, or looked for in vain: what a cache entry depends on.
struct Dependency {
  std::filesystem::path path;
  std::string contentHash;  ///< Empty: the file was searched for and absent.
};

struct CompiledSource {
  std::shared_ptr<const Program> program;
  std::shared_ptr<const Program> layer;  ///< The shader as a layer of groups (see group.h).
  std::vector<Dependency> dependencies;
  Diagnostics warnings;
  Diagnostics remarks;  ///< What an OSL renderer says when it makes code of the shader, in its words; notes.
};

/// The program of its own that a layer's shader is (see `complete` in lower.h), without what no output needs.
std::shared_ptr<const Program> programOf(const Program& layer);

/// Compiles the shader of a source file, or of a compiled file (compiled_file.h). (The last `shader` declaration is the
/// shader, as in OSL.) Errors carry positions with their source lines; as many as can be found in one run.
Result<CompiledSource> compileFile(const std::filesystem::path& path, const CompileOptions& options);

/// The same from a string; `name` stands for the file in messages.
Result<CompiledSource> compileString(const std::string& text, const std::string& name, const CompileOptions& options);

}  // namespace aerosol::lang

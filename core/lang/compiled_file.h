// Compiled files (.oso): a shader that was checked, preprocessed, in one file that needs no other.
//
// The file is text: a head, and the source after the preprocessor with line markers. What the standard library's header
// gave is left out and put in front again when the file is read. So a file keeps its meaning whatever a later version
// does with programs, and its messages name the places of the original source.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/lang/compile.h"
#include "core/lang/parser.h"

namespace aerosol::lang {

struct Preprocessed {
  std::string text;                      ///< With line markers; without what the standard library's header gave.
  std::vector<Dependency> dependencies;  ///< The file, what it includes, the standard library's header.
  Diagnostics warnings;
};

/// Runs the preprocessor alone.
Result<Preprocessed> preprocessFile(const std::filesystem::path& path, const CompileOptions& options);

/// A compiled file's text. `source` is what `preprocessFile` gave for a shader that compiles; `kind` and `name` are the
/// shader's. `comments` are lines for people.
std::string compiledFileText(const Preprocessed& source, const std::string& kind, const std::string& name,
                             const std::vector<std::string>& comments);

/// The source in the text of a compiled file at `path`, for `compileString`; an error when it is none.
Result<std::string> sourceOfCompiledFile(const std::string& text, const std::string& path);

/// Parses a source file or a compiled file.
Result<ParsedSource> parseShaderFile(const std::filesystem::path& path, const CompileOptions& options);

/// Does the name say that it is a compiled file?
bool isCompiledFile(const std::filesystem::path& path);

}  // namespace aerosol::lang

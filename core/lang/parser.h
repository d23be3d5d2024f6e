// From a shader's source text to its syntax tree.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/lang/ast.h"
#include "core/lang/compile.h"
#include "core/lang/lexer.h"
#include "core/lang/source_map.h"

namespace aerosol::lang {

/// A source file that is free of syntax errors.
///
/// Positions stand for: the operator of Unary, Binary, Assign, Conditional and Comma; the `[` of Index; the field's
/// name of Field; the first token of every other expression and of statements; the declared name of declarations and of
/// metadata.
struct ParsedSource {
  SourceFile file;  ///< The declarations of stdosl.h come first (see SourceMap::isInPrelude).
  std::shared_ptr<const SourceMap> sourceMap;
  std::vector<Dependency> dependencies;
  Diagnostics warnings;
};

/// How deep statements, parentheses, calls and initialisers may nest, and how deep the tree of one expression may be
/// (a chain of n operators is n deep): bounds for every recursive walk over the tree.
inline constexpr int maximumNesting = 256;
inline constexpr int maximumExpressionDepth = 1024;
inline constexpr int maximumElseIfs = 1024;

/// Preprocesses and parses a file, with `options.standardLibrary` included before its first line (an empty path: no
/// such header). Every error that can be found in one run is reported, up to `maximumErrors`.
Result<ParsedSource> parseFile(const std::filesystem::path& path, const CompileOptions& options);

/// The same from a string; `name` stands for the file in messages, and includes are searched for in its folder.
Result<ParsedSource> parseString(const std::string& text, const std::string& name, const CompileOptions& options);

/// Parses tokens; errors go to `diagnostics`. What was understood is returned in any case. `strict`: see
/// CompileOptions.
SourceFile parseTokens(const TokenStream& tokens, const SourceMap& sourceMap, Diagnostics& diagnostics,
                       bool strict = false);

}  // namespace aerosol::lang

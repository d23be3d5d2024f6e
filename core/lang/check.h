// The type checker: fills in what the syntax tree leaves open and finds every error of meaning.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/lang/ast.h"
#include "core/lang/builtins.h"
#include "core/lang/program.h"
#include "core/lang/source_map.h"

namespace aerosol::lang {

/// What the nodes of a checked tree point to, and what lowering needs besides the tree. Keep it as long as the tree.
struct CheckedSource {
  ShaderDeclaration* shader = nullptr;  ///< The last one of the file.
  std::vector<std::unique_ptr<StructType>> structs;
  std::vector<std::unique_ptr<VariableDeclaration>> globals;  ///< In the order of `Global`.
  BuiltinOverloads builtins;
  /// Definitions of functions that were declared before, by their declaration.
  std::map<const FunctionDeclaration*, const FunctionDeclaration*> definitions;
};

/// `closure color name(…) [[ int builtin = 1 ]];`: a closure that only its declaration makes known.
bool isDeclaredClosure(const FunctionDeclaration& function);

/// Limits on what a source may ask for.
inline constexpr int maximumArrayLength = 65536;
inline constexpr std::size_t maximumStructureLeaves = 65536;  ///< Fields of fields and so on, without array lengths.

/// Checks everything in the author's files, and of the standard library what they call. Errors and warnings are added
/// to `diagnostics`; the tree may be lowered only when there are no errors. Without `advice` only what oslc warns of;
/// `strict`: see CompileOptions.
std::unique_ptr<CheckedSource> check(SourceFile& file, const SourceMap& sourceMap, Diagnostics& diagnostics,
                                     bool advice = true, bool strict = false);

}  // namespace aerosol::lang

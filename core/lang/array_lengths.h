// Shader parameters that are arrays without a length: `float knots[] = {0, 1}`. They are as long as what an instance or
// a connection gives them, and only else as their default; so their shader is compiled for these lengths.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/lang/ast.h"
#include "core/lang/compile.h"
#include "core/lang/group.h"

namespace aerosol::lang {

/// By the parameter's name.
using ArrayLengths = std::map<std::string, int>;

/// Was it declared without a length?
bool isUnsized(const Parameter& parameter);

/// As in compile.h, with lengths for parameters that have none.
Result<CompiledSource> compileFile(const std::filesystem::path& path, const CompileOptions& options,
                                   const ArrayLengths& lengths);
Result<CompiledSource> compileString(const std::string& text, const std::string& name, const CompileOptions& options,
                                     const ArrayLengths& lengths);

/// Layers whose values and connections bring arrays of other lengths are replaced by what `recompile` gives for these.
/// The errors of that are the result.
Diagnostics fitArrays(Group& group, const std::function<Result<std::shared_ptr<const Program>>(
                                        std::size_t layer, const ArrayLengths& lengths)>& recompile);

// For the compilation itself.

/// Is the declaration of a parameter without a length?
bool isUnsized(const VariableDeclaration& parameter);

/// Names of the shader's parameters that have no length; those with a length given get it.
std::vector<std::string> setArrayLengths(SourceFile& file, const ArrayLengths& lengths);
void markUnsized(Program& program, const std::vector<std::string>& names);

}  // namespace aerosol::lang

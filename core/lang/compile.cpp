#include "core/lang/compile.h"

#include <utility>

#include "core/base/paths.h"
#include "core/lang/analysis.h"
#include "core/lang/array_lengths.h"
#include "core/lang/check.h"
#include "core/lang/compiled_file.h"
#include "core/lang/lower.h"
#include "core/lang/native.h"
#include "core/lang/parser.h"

namespace aerosol::lang {

namespace {

Result<CompileOptions> withLibrary(CompileOptions options) {
  if (!options.standardLibrary.empty()) return options;
  auto installation = findInstallation();
  if (!installation) return installation.errors();
  options.standardLibrary = installation->shaders / "stdosl.h";
  return options;
}

Result<CompiledSource> compile(Result<ParsedSource> parsed, const CompileOptions& options,
                               const ArrayLengths& lengths) {
  if (!parsed) return parsed.errors();
  const std::vector<std::string> unsized = setArrayLengths(parsed->file, lengths);
  Diagnostics diagnostics = std::move(parsed->warnings);
  const auto checked = check(parsed->file, *parsed->sourceMap, diagnostics, options.advice, options.strict);
  if (diagnostics.hasErrors()) return diagnostics;
  auto shader = lower(*checked, *parsed->sourceMap, diagnostics, options.natives.get());
  if (!shader) return diagnostics;
  CompiledSource result;
  result.program = std::make_shared<const Program>(slice(shader->program, shader->program.outputs, Messages::keep));
  markUnsized(shader->layer, unsized);
  result.layer = std::make_shared<const Program>(std::move(shader->layer));
  result.dependencies = std::move(parsed->dependencies);
  for (const FunctionUse& function : result.layer->functions)
    if (const auto name = parseNativeSymbol(function.symbol))
      result.dependencies.push_back({name->file, name->contentHash});
  for (Diagnostic& each : diagnostics.entries())
    (each.severity == Severity::note ? result.remarks : result.warnings).add(std::move(each));
  return result;
}

}  // namespace

std::shared_ptr<const Program> programOf(const Program& layer) {
  // What could be wrong was found when the layer was compiled.
  const Program program = complete(layer, [](std::uint32_t, const std::string&) {});
  return std::make_shared<const Program>(slice(program, program.outputs, Messages::keep));
}

Result<CompiledSource> compileFile(const std::filesystem::path& path, const CompileOptions& options) {
  return compileFile(path, options, {});
}

Result<CompiledSource> compileFile(const std::filesystem::path& path, const CompileOptions& options,
                                   const ArrayLengths& lengths) {
  auto complete = withLibrary(options);
  if (!complete) return complete.errors();
  auto compiled = compile(parseShaderFile(path, *complete), options, lengths);
  // Whoever wrote a compiled file has heard them.
  if (compiled && path.extension() == ".oso") compiled->warnings = {};
  return compiled;
}

Result<CompiledSource> compileString(const std::string& text, const std::string& name, const CompileOptions& options) {
  return compileString(text, name, options, {});
}

Result<CompiledSource> compileString(const std::string& text, const std::string& name, const CompileOptions& options,
                                     const ArrayLengths& lengths) {
  auto complete = withLibrary(options);
  if (!complete) return complete.errors();
  return compile(parseString(text, name, *complete), options, lengths);
}

}  // namespace aerosol::lang

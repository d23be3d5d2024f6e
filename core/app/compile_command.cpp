#include "core/app/compile_command.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "core/app/quantity.h"
#include "core/app/toolchain.h"
#include "core/shading/shading_system.h"

namespace aerosol::app {

namespace {

/// A kernel made of a shader, and what it delivers.
struct Variant {
  const char* name;
  jit::Kernel kernel;
};

double secondsOf(const jit::CompileTimes& t) {
  return t.lowering + t.linkRuntime + t.optimisation + t.codeGeneration + t.loading;
}

/// Kernels of volumes and surfaces, as a scene would have them.
Result<std::vector<Variant>> compileForScene(const std::shared_ptr<const lang::Program>& program,
                                             const Toolchain& toolchain) {
  shading::ShadingSystem system;
  system.add(program, {});
  Diagnostics errors = system.compile(*toolchain.compiler, {toolchain.target, false});
  if (errors.hasErrors()) return errors;
  const shading::Family& family = system.families().front();
  constexpr std::pair<shading::Variant, const char*> variants[] = {{shading::Variant::coefficients, "coefficients"},
                                                                   {shading::Variant::extinction, "extinction"},
                                                                   {shading::Variant::surface, "closures"},
                                                                   {shading::Variant::displacement, "displacement"}};
  std::vector<Variant> made;
  for (const auto& [variant, name] : variants) {
    const auto& kernel = family.kernels[static_cast<std::size_t>(variant)];
    if (kernel) made.push_back({name, *kernel});
  }
  return made;
}

/// The one kernel of a shader that no scene places by itself: all its outputs.
Result<std::vector<Variant>> compileOutputs(const std::shared_ptr<const lang::Program>& program,
                                            const Toolchain& toolchain) {
  jit::KernelRequest request;
  request.program = program;
  request.outputs = program->outputs;
  for (std::uint32_t i = 0; i < program->parameters.size(); ++i) {
    const lang::Parameter& parameter = program->parameters[i];
    request.folded.push_back({i, parameter.hasConstantDefault ? parameter.defaultValue : lang::ConstantValue{}});
  }
  request.target = toolchain.target;
  auto kernel = toolchain.compiler->compile(request);
  if (!kernel) return kernel.errors();
  return std::vector<Variant>{{"outputs", std::move(*kernel)}};
}

std::string describe(const Variant& variant) {
  const jit::CompileTimes& times = variant.kernel.times();
  return fmt::format("{} {}{}, cost {:.0f}", variant.name, formatDuration(secondsOf(times)),
                     times.fromCache ? " from the cache" : "", variant.kernel.interface().staticCost);
}

std::string describe(const lang::Program& program, const std::vector<Variant>& variants) {
  std::size_t parameters = 0;
  for (const lang::Parameter& parameter : program.parameters) parameters += !parameter.isOutput;
  std::string text =
      fmt::format("{} {}: {} parameter{}", program.kind, program.name, parameters, parameters == 1 ? "" : "s");
  for (const Variant& variant : variants) text += "; " + describe(variant);
  return text + "\n";
}

bool compileShader(const std::filesystem::path& file, bool warningsAreErrors, const Toolchain& toolchain,
                   shading::ShaderLibrary& library, const Console& console) {
  Diagnostics warnings;
  const auto program = library.load(file, warnings);
  if (warningsAreErrors)
    for (Diagnostic& warning : warnings.entries()) warning.severity = Severity::error;
  console.report(warnings);
  if (!program) {
    console.report(program.errors());
    return false;
  }
  if (warningsAreErrors && !warnings.empty()) return false;
  const bool isPlaced = (*program)->kind != "shader";
  const auto variants = isPlaced ? compileForScene(*program, toolchain) : compileOutputs(*program, toolchain);
  if (!variants) {
    console.report(variants.errors());
    return false;
  }
  console.print(describe(**program, *variants));
  return true;
}

}  // namespace

ExitCode compileCommand(const CompileArguments& arguments, const Console& console) {
  Diagnostics warnings;
  const auto toolchain = openToolchain(arguments.kernels, warnings);
  console.report(warnings);
  if (!toolchain) {
    console.report(toolchain.errors());
    return ExitCode::badInput;
  }
  shading::ShaderLibrary library = openShaderLibrary(arguments.kernels, toolchain->installation, toolchain->cache,
                                                     arguments.defines, arguments.undefines);
  bool allCompiled = true;
  for (const std::filesystem::path& shader : arguments.shaders) {
    allCompiled = compileShader(shader, arguments.warningsAreErrors, *toolchain, library, console) && allCompiled;
  }
  return allCompiled ? ExitCode::success : ExitCode::badInput;
}

}  // namespace aerosol::app

#include "core/app/toolchain.h"

#include <fmt/format.h>

#include <utility>

#include "core/shading/native_plugins.h"

namespace aerosol::app {

std::shared_ptr<jit::ObjectCache> openCache(const KernelArguments& arguments, Diagnostics& warnings) {
  if (!arguments.useCache) return nullptr;
  const std::filesystem::path folder = jit::ObjectCache::defaultFolder();
  if (folder.empty()) return nullptr;
  auto cache = jit::ObjectCache::open(folder);
  if (cache) return *cache;
  for (Diagnostic problem : cache.errors().entries()) {
    problem.severity = Severity::warning;
    problem.notes.push_back("shaders are compiled anew every time");
    warnings.add(std::move(problem));
  }
  return nullptr;
}

Result<Toolchain> openToolchain(const KernelArguments& arguments, Diagnostics& warnings) {
  auto installation = findInstallation();
  if (!installation) return installation.errors();
  for (const std::filesystem::path& folder : arguments.shaderPath) {
    std::error_code ignored;
    if (folder.empty() || std::filesystem::is_directory(folder, ignored)) continue;
    warnings.warning({}, fmt::format("'{}', where shaders are to be looked for, is no folder", folder.string()),
                     {"folders come from --shader-path and from $AEROSOL_SHADER_PATH"});
  }
  const auto isa = arguments.isa.empty() ? std::nullopt : std::optional<std::string_view>(arguments.isa);
  const auto target = jit::chooseTarget(arguments.width, isa);
  if (!target) return target.errors();
  std::shared_ptr<jit::ObjectCache> cache = openCache(arguments, warnings);
  auto compiler = jit::Compiler::create({installation->runtime, cache});
  if (!compiler) return compiler.errors();
  return Toolchain{std::move(*installation), std::move(cache), std::move(*compiler), *target};
}

std::shared_ptr<lang::NativeSource> openPlugins(const std::vector<std::filesystem::path>& folders) {
  std::vector<std::filesystem::path> all;
  for (const std::filesystem::path& folder : folders) {
    for (const char* kind : {"", "volume", "surface", "displacement", "light", "texture"})
      all.push_back((folder.empty() ? std::filesystem::path(".") : folder) / kind);
  }
  return std::make_shared<shading::NativePlugins>(std::move(all));
}

shading::ShaderLibrary openShaderLibrary(const KernelArguments& arguments, const Installation& installation,
                                         std::shared_ptr<jit::ObjectCache> cache, std::vector<std::string> defines,
                                         std::vector<std::string> undefines) {
  std::vector<std::filesystem::path> path = arguments.shaderPath;
  path.push_back(installation.shaders);
  path.push_back(installation.plugins);
  lang::CompileOptions options;
  options.includePaths = path;
  options.defines = std::move(defines);
  options.undefines = std::move(undefines);
  options.standardLibrary = installation.shaders / "stdosl.h";
  return {path, options, std::move(cache)};
}

}  // namespace aerosol::app

#include "core/app/tools/plugin_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/base/child_process.h"
#include "core/base/paths.h"
#include "core/shading/native_plugins.h"

namespace aerosol::app {

namespace fs = std::filesystem;

namespace {

constexpr int compileSeconds = 600;

bool isPlainC(const fs::path& file) { return file.extension() == ".c"; }

/// The first of the names that runs.
std::string findClang(bool isC) {
  if (const char* chosen = std::getenv("AEROSOL_CLANG")) return chosen;
  for (const std::string version : {"-19", "-18", "-17", "-16", "-15", ""}) {
    const std::string name = (isC ? "clang" : "clang++") + version;
    const auto child = runChild({name, "--version"}, compileSeconds);
    if (child && child->exitCode == 0) return name;
  }
  return {};
}

bool fail(const Console& console, const fs::path& file, std::string message, std::vector<std::string> notes = {}) {
  console.report(Diagnostic{Severity::error, {file.string(), 0, 0}, std::move(message), {}, std::move(notes)});
  return false;
}

}  // namespace

bool isPluginSource(const fs::path& file) {
  static constexpr std::array<const char*, 4> extensions = {".c", ".cc", ".cpp", ".cxx"};
  return std::ranges::any_of(extensions, [&](const char* extension) { return file.extension() == extension; });
}

bool compilePluginSource(const fs::path& file, const CompileArguments& arguments, const Console& console) {
  const auto installation = findInstallation();
  if (!installation) {
    console.report(installation.errors());
    return false;
  }
  const std::string clang = findClang(isPlainC(file));
  if (clang.empty())
    return fail(console, file, "there is no clang to compile it with", {"$AEROSOL_CLANG may name one, 19 or older"});
  const std::string target =
      arguments.outputFile.empty() ? file.stem().string() + ".bc" : std::string(arguments.outputFile);
  std::error_code ignored;
  const fs::path sources = fs::canonical(installation->shaders, ignored).parent_path();  // Of a build tree.
  std::vector<std::string> words = {clang,
                                    "-emit-llvm",
                                    "-c",
                                    "-O2",
                                    "-fno-math-errno",
                                    "-ffp-contract=off",
                                    "-fno-vectorize",
                                    "-fno-slp-vectorize",
                                    "-fno-unroll-loops",
                                    "-I" + (installation->prefix / "include").string(),
                                    "-I" + (sources / "plugins" / "sdk").string()};
  if (!isPlainC(file)) words.insert(words.end(), {"-std=c++20", "-fno-exceptions", "-fno-rtti"});
  for (const fs::path& folder : arguments.kernels.shaderPath) words.push_back("-I" + folder.string());
  for (const std::string& define : arguments.defines) words.push_back("-D" + define);
  if (arguments.warningsAreErrors) words.emplace_back("-Werror");
  words.insert(words.end(), {"-o", target, file.string()});
  std::fflush(console.out);
  const auto child = runChild(words, compileSeconds, true);
  if (!child) return fail(console, file, fmt::format("{}: {}", clang, child.errors().entries().front().message));
  if (child->exitCode != 0 || child->signal != 0) return fail(console, file, "it does not compile");
  shading::NativePlugins plugins({});
  if (const auto plugin = plugins.open(target, {}); !plugin) {
    console.report(plugin.errors());
    return false;
  }
  if (!arguments.quiet) console.print(fmt::format("Compiled {} -> {}\n", file.string(), target));
  return true;
}

}  // namespace aerosol::app

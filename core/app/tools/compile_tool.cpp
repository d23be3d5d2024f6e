#include "core/app/tools/compile_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "core/app/compile_command.h"
#include "core/app/toolchain.h"
#include "core/app/tools/osl_form.h"
#include "core/app/tools/plugin_source.h"
#include "core/base/paths.h"
#include "core/lang/compiled_file.h"
#include "core/lang/shader_interface.h"

namespace aerosol::app {

namespace {

namespace fs = std::filesystem;

Diagnostic fileError(const fs::path& file, const std::string& what) {
  return {Severity::error, {file.string(), 0, 0}, fmt::format("{}: {}", what, std::strerror(errno)), {}, {}};
}

/// As seen from the current folder, where it lies there.
std::string shortened(const fs::path& path) {
  std::error_code ignored;
  const fs::path relative = path.lexically_relative(fs::current_path(ignored));
  return relative.empty() || *relative.begin() == ".." ? path.string() : relative.string();
}

/// The programs of compiled files, and everything else that oslc writes.
class FileCompiler {
 public:
  FileCompiler(const CompileArguments& arguments, bool isOslc, lang::CompileOptions options, const Console& console)
      : arguments_(arguments), isOslc_(isOslc), options_(std::move(options)), console_(console) {}

  bool compile(const fs::path& file);

 private:
  bool compileSource(const fs::path& file, const lang::Preprocessed& source);
  bool writeDependencies(const fs::path& file, const lang::Preprocessed& source);
  bool write(const fs::path& file, const std::string& text);
  bool report(const Diagnostics& diagnostics);
  bool report(const Diagnostic& diagnostic) {
    Diagnostics one;
    one.add(diagnostic);
    return report(one);
  }

  const CompileArguments& arguments_;
  bool isOslc_;
  lang::CompileOptions options_;
  const Console& console_;
};

/// False when one of them is an error.
bool FileCompiler::report(const Diagnostics& diagnostics) {
  bool isGood = true;
  for (Diagnostic each : diagnostics.entries()) {
    if (arguments_.warningsAreErrors && each.severity == Severity::warning) each.severity = Severity::error;
    isGood = isGood && each.severity != Severity::error;
    if (arguments_.quiet && each.severity == Severity::warning) continue;
    console_.note(isOslc_ ? asOslc(each) + "\n" : format(each));
  }
  return isGood;
}

bool FileCompiler::write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  return stream ? true : report(fileError(file, "cannot write this file"));
}

bool FileCompiler::writeDependencies(const fs::path& file, const lang::Preprocessed& source) {
  const DependencyArguments& wanted = arguments_.dependencies;
  fs::path target = wanted.target.empty() ? fs::path(arguments_.outputFile) : fs::path(wanted.target);
  if (target.empty()) target = fs::path(file).replace_extension(".oso");
  std::string rule = fmt::format("{}: {}", target.string(), file.string());
  std::error_code ignored;
  const fs::path itself = fs::absolute(file, ignored);
  for (const lang::Dependency& dependency : source.dependencies) {
    const bool isAbsent = dependency.contentHash.empty();
    const bool isLibrary = dependency.path == options_.standardLibrary;
    if (isAbsent || dependency.path == itself || (isLibrary && !wanted.standardLibrary)) continue;
    rule += " \\\n  " + shortened(dependency.path);
  }
  rule += "\n";
  if (wanted.alone && wanted.file.empty()) {
    console_.print(rule);
    return true;
  }
  return write(wanted.file.empty() ? fs::path(file).replace_extension(".d") : fs::path(wanted.file), rule);
}

/// Only oslc writes a compiled file that nobody has named.
bool FileCompiler::compileSource(const fs::path& file, const lang::Preprocessed& source) {
  auto compiled = lang::compileFile(file, options_);
  if (!compiled) return report(compiled.errors());
  if (!report(compiled->warnings)) return false;
  if (!isOslc_ && arguments_.outputFile.empty()) return true;
  const lang::Program& program = *compiled->program;
  const std::string target = arguments_.outputFile.empty() ? program.name + ".oso" : arguments_.outputFile;
  if (!write(target, lang::compiledFileText(source, program.kind, program.name, {"from " + file.string()})))
    return false;
  if (!arguments_.quiet) console_.print(fmt::format("Compiled {} -> {}\n", file.string(), target));
  return true;
}

bool FileCompiler::compile(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    return report(Diagnostic{.message = fmt::format("Input file \"{}\" not found", file.string())});
  }
  const auto source = lang::preprocessFile(file, options_);
  if (!source) return report(source.errors());
  if (arguments_.dependencies.wanted && !writeDependencies(file, *source)) return false;
  if (arguments_.dependencies.alone) return true;
  if (arguments_.preprocessOnly) {
    console_.print(source->text);
    return true;
  }
  return compileSource(file, *source);
}

}  // namespace

ExitCode compileTool(const ToolArguments& call, const Console& console) {
  auto parsed = parseCompileArguments(call.words);
  if (call.isOsl && call.words.empty()) {
    console.print(compileHelp());
    return ExitCode::success;
  }
  if (const Reply* reply = std::get_if<Reply>(&parsed)) {
    reply->code == ExitCode::success ? console.print(reply->text) : console.note(reply->text);
    return reply->code;
  }
  CompileArguments& arguments = std::get<CompileArguments>(parsed);
  std::ranges::copy(call.shaderPath, std::back_inserter(arguments.kernels.shaderPath));
  if (!call.isOsl || arguments.verbose) {
    for (const std::string& option : arguments.ignored)
      console.note(fmt::format("note: {} means nothing here and is ignored\n", option));
  }
  const auto isSource = [](const fs::path& file) { return isPluginSource(file); };
  bool allCompiled = true;
  for (const fs::path& file : arguments.shaders)
    if (isSource(file)) allCompiled = compilePluginSource(file, arguments, console) && allCompiled;
  std::erase_if(arguments.shaders, isSource);
  if (arguments.shaders.empty()) return allCompiled ? ExitCode::success : ExitCode::badInput;
  const bool writesFiles = call.isOsl || arguments.preprocessOnly || arguments.dependencies.wanted ||
                           arguments.verbose || arguments.quiet || !arguments.outputFile.empty();
  if (!writesFiles) {
    const ExitCode code = compileCommand(arguments, console);
    return allCompiled ? code : ExitCode::badInput;
  }

  const auto installation = findInstallation();
  if (!installation) {
    console.report(installation.errors());
    return ExitCode::badInput;
  }
  lang::CompileOptions options;
  options.includePaths = arguments.kernels.shaderPath;
  options.includePaths.push_back(installation->shaders);
  options.defines = arguments.defines;
  options.undefines = arguments.undefines;
  options.strict = call.isOsl;
  options.advice = !call.isOsl || arguments.advice;
  options.standardLibrary = installation->shaders / "stdosl.h";
  std::vector<fs::path> folders = {""};
  for (const fs::path& file : arguments.shaders) folders.push_back(file.parent_path());
  folders.insert(folders.end(), options.includePaths.begin(), options.includePaths.end());
  folders.push_back(installation->plugins);
  options.natives = openPlugins(folders);
  FileCompiler compiler(arguments, call.isOsl, std::move(options), console);
  for (const fs::path& file : arguments.shaders) {
    const bool isGood = compiler.compile(file);
    if (!isGood && call.isOsl) console.print(fmt::format("FAILED {}\n", file.string()));
    allCompiled = allCompiled && isGood;
  }
  return allCompiled ? ExitCode::success : ExitCode::badInput;
}

}  // namespace aerosol::app

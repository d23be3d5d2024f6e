#include "core/shading/native_plugins.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "core/base/child_process.h"
#include "core/base/hash.h"
#include "core/jit/native_bitcode.h"

namespace aerosol::shading {

namespace fs = std::filesystem;

namespace {

constexpr const char* descriptorName = "aerosol_shader_plugin";
constexpr int checkSeconds = 20;

/// An open shared object. It is never closed: code of it may stand on the stacks of threads that outlive us.
struct Library {
  std::shared_ptr<void> handle;
  const AerosolShaderPlugin* plugin = nullptr;
};

/// Nothing binds to the program's own symbols: RTLD_LOCAL for the plugin, and the program exports none.
std::string openLibrary(const fs::path& file, Library& library) {
  void* const handle = dlopen(fs::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char* const reason = dlerror();
    return fmt::format("it cannot be loaded: {}", reason ? reason : "no reason given");
  }
  library.handle = std::shared_ptr<void>(handle, [](void*) {});
  library.plugin = static_cast<const AerosolShaderPlugin*>(dlsym(handle, descriptorName));
  if (!library.plugin) return fmt::format("it does not export '{}'", descriptorName);
  if (library.plugin->abi != AEROSOL_SHADER_ABI) {
    return fmt::format("it was built for version {} of the plugin interface, and this is version {}",
                       library.plugin->abi, static_cast<int>(AEROSOL_SHADER_ABI));
  }
  if (library.plugin->size < sizeof(AerosolShaderPlugin)) return "its description is too short";
  return {};
}

std::string initialise(const AerosolShaderPlugin& plugin) {
  if (!plugin.initialise) return {};
  std::array<char, 1024> message{};
  if (plugin.initialise(message.data(), message.size() - 1) == 0) return {};
  return message[0] ? fmt::format("it cannot work here: {}", message.data())
                    : "it cannot work here, and does not say why";
}

Diagnostic failure(const fs::path& file, const SourceLocation& place, const std::string& reason) {
  return Diagnostic{Severity::error, place, fmt::format("plugin '{}': {}", file.string(), reason), {}, {}};
}

/// What the child process found; nothing when all is well.
std::string check(const fs::path& checker, const fs::path& file) {
  const auto child = runChild({checker.string(), "--check-plugin", fs::absolute(file).string()}, checkSeconds);
  if (!child) return fmt::format("it cannot be checked: {}", child.errors().entries().front().message);
  if (child->timedOut) return fmt::format("its initialiser did not end within {} seconds", checkSeconds);
  if (child->signal != 0) return fmt::format("its initialiser crashed: {}", child->signalName());
  if (child->exitCode == 0) return {};
  std::string text = child->output;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.empty() ? fmt::format("its initialiser ended the program with {}", child->exitCode) : text;
}

/// As one text: "has functions a; b".
std::string listOf(const std::vector<std::string>& declarations) {
  if (declarations.empty()) return "the plugin has no functions";
  return fmt::format("its functions are: {}", fmt::join(declarations, "; "));
}

Result<std::shared_ptr<const NativePlugin>> readObject(const fs::path& file, const std::string& hash,
                                                       const fs::path& checker, const SourceLocation& place) {
  if (const std::string problem = check(checker, file); !problem.empty()) return failure(file, place, problem);
  Library library;
  std::string problem = openLibrary(file, library);
  if (problem.empty()) problem = initialise(*library.plugin);
  if (!problem.empty()) return failure(file, place, problem);
  auto plugin = std::make_shared<NativePlugin>();
  plugin->file = file;
  plugin->name = library.plugin->name ? library.plugin->name : "";
  plugin->shader = library.plugin->shader ? library.plugin->shader : "";
  for (std::uint32_t i = 0; i < library.plugin->functionCount; ++i) {
    const AerosolShaderFunction& row = library.plugin->functions[i];
    const auto signature = lang::nativeSignature(row.declaration ? row.declaration : "");
    const std::string what =
        fmt::format("its function number {}, \"{}\",", i + 1, row.declaration ? row.declaration : "");
    if (!signature) return failure(file, place, what + " is not declared as in a shader: \"float f(point p, int n)\"");
    if (!row.evaluate) return failure(file, place, what + " has no code");
    auto function = std::make_shared<ObjectFunction>();
    function->signature = *signature;
    function->symbol = lang::nativeSymbol({file, hash, *signature});
    function->hasRange = row.range != nullptr;
    function->evaluate = row.evaluate;
    function->range = row.range;
    function->library = library.handle;
    plugin->declarations.emplace_back(row.declaration);
    plugin->functions.push_back(std::move(function));
  }
  return std::shared_ptr<const NativePlugin>(std::move(plugin));
}

Result<std::shared_ptr<const NativePlugin>> readBitcode(const fs::path& file, const std::string& hash,
                                                        const SourceLocation& place) {
  std::ifstream in(file, std::ios::binary);
  auto bytes = std::make_shared<std::string>(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  const auto described = jit::readNativeBitcode(*bytes);
  if (!described) return failure(file, place, described.errors().entries().front().message);
  auto plugin = std::make_shared<NativePlugin>();
  plugin->file = file;
  plugin->name = described->name;
  plugin->shader = described->shader;
  for (const jit::NativeBitcode::Function& row : described->functions) {
    const auto signature = lang::nativeSignature(row.declaration);
    if (!signature) return failure(file, place, fmt::format("'{}' is no declaration of a function", row.declaration));
    auto function = std::make_shared<lang::NativeFunction>();
    function->signature = *signature;
    function->symbol = lang::nativeSymbol({file, hash, *signature});
    function->hasRange = !row.range.empty();
    function->bitcode = bytes;
    function->evaluateName = row.evaluate;
    function->rangeName = row.range;
    plugin->declarations.push_back(row.declaration);
    plugin->functions.push_back(std::move(function));
  }
  return std::shared_ptr<const NativePlugin>(std::move(plugin));
}

}  // namespace

bool isPluginFile(const fs::path& file) {
  const std::string extension = file.extension().string();
  return std::ranges::any_of(pluginExtensions, [&](const char* known) { return extension == known; });
}

std::string tryPlugin(const fs::path& file) {
  Library library;
  const std::string problem = openLibrary(file, library);
  return problem.empty() ? initialise(*library.plugin) : problem;
}

NativePlugins::NativePlugins(std::vector<fs::path> folders, fs::path checker)
    : folders_(std::move(folders)), checker_(std::move(checker)) {
  if (checker_.empty()) checker_ = "/proc/self/exe";
}

Result<std::shared_ptr<const NativePlugin>> NativePlugins::open(const fs::path& file, const SourceLocation& place) {
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  const fs::path absolute = fs::absolute(file, ignored).lexically_normal();
  if (const auto known = opened_.find(absolute); known != opened_.end()) return known->second;
  const auto hash = hashFile(absolute);
  if (!hash) return failure(file, place, "it cannot be read");
  auto plugin = absolute.extension() == ".bc" ? readBitcode(absolute, *hash, place)
                                              : readObject(absolute, *hash, checker_, place);
  if (plugin) opened_[absolute] = *plugin;
  return plugin;
}

Result<std::shared_ptr<const lang::NativeFunction>> NativePlugins::find(const std::string& plugin,
                                                                        const std::string& signature,
                                                                        const SourceLocation& place) {
  std::vector<fs::path> candidates;
  if (isPluginFile(plugin)) candidates.emplace_back(plugin);
  for (const char* extension : pluginExtensions)  // Beside the shader.
    candidates.push_back(fs::path(place.file).parent_path() / (plugin + extension));
  for (const fs::path& folder : folders_)
    for (const char* extension : pluginExtensions) candidates.push_back(folder / (plugin + extension));
  std::error_code ignored;
  const auto file =
      std::ranges::find_if(candidates, [&](const fs::path& path) { return fs::is_regular_file(path, ignored); });
  if (file == candidates.end()) {
    std::string list;
    for (const fs::path& folder : folders_) list += (list.empty() ? "" : ", ") + folder.string();
    return Diagnostic{Severity::error,
                      place,
                      fmt::format("there is no plugin '{}'", plugin),
                      {},
                      {fmt::format("{0}.so and {0}.bc were looked for in: {1}", plugin, list)}};
  }
  auto opened = open(*file, place);
  if (!opened) return opened.errors();
  for (const auto& function : (*opened)->functions)
    if (function->signature == signature) return function;
  return Diagnostic{Severity::error,
                    place,
                    fmt::format("plugin '{}' has no function '{}'", plugin, signature),
                    {},
                    {listOf((*opened)->declarations)}};
}

std::shared_ptr<const lang::NativeFunction> NativePlugins::findSymbol(const std::string& symbol) {
  const auto name = lang::parseNativeSymbol(symbol);
  if (!name) return nullptr;
  const auto plugin = open(name->file, {});
  if (!plugin) return nullptr;
  for (const auto& function : (*plugin)->functions)
    if (function->symbol == symbol) return function;
  return nullptr;
}

Result<lang::CompiledSource> compilePlugin(const fs::path& file, const lang::CompileOptions& options) {
  const SourceLocation place{file.string(), 0, 0};
  auto* const natives = dynamic_cast<NativePlugins*>(options.natives.get());
  if (!natives) return failure(file, {}, "plugins cannot be used here");
  const auto plugin = natives->open(file, {});
  if (!plugin) return plugin.errors();
  if ((*plugin)->shader.empty()) {
    Diagnostic error = failure(file, {}, "it brings functions, but no shader");
    error.notes.push_back(listOf((*plugin)->declarations));
    return error;
  }
  std::string text;
  for (const std::string& declaration : (*plugin)->declarations)
    text += fmt::format("{} [[ string native = \"{}\" ]];\n", declaration, (*plugin)->file.string());
  auto compiled = lang::compileString(text + "#line 1\n" + (*plugin)->shader, file.string(), options);
  if (compiled) compiled->dependencies.push_back({(*plugin)->file, hashFile((*plugin)->file).value_or("")});
  return compiled;
}

}  // namespace aerosol::shading

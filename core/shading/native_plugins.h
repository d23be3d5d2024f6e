// Native plugins on the search path: opened once, after a look from another process, and kept until the program ends.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/lang/compile.h"
#include "core/lang/native.h"
#include "plugins/sdk/aerosol_shader.h"

namespace aerosol::shading {

inline constexpr std::array<const char*, 2> pluginExtensions = {".so", ".bc"};
bool isPluginFile(const std::filesystem::path& file);

/// A function of a shared object.
struct ObjectFunction final : lang::NativeFunction {
  AerosolEvaluate evaluate = nullptr;
  AerosolRange range = nullptr;
  std::shared_ptr<const void> library;  ///< Keeps the code in memory.
};

/// A plugin that was opened.
struct NativePlugin {
  std::filesystem::path file;
  std::string name;
  std::string shader;                     ///< Source of the shader that it brings; empty: none.
  std::vector<std::string> declarations;  ///< Of its functions, as it writes them.
  std::vector<std::shared_ptr<const lang::NativeFunction>> functions;
};

class NativePlugins final : public lang::NativeSource {
 public:
  /// Folders are searched in order. Shared objects are first opened by `aerosol --check-plugin FILE` (the running
  /// program; in another program, such as a test: `checker`): what crashes there is an error here.
  explicit NativePlugins(std::vector<std::filesystem::path> folders, std::filesystem::path checker = {});

  Result<std::shared_ptr<const lang::NativeFunction>> find(const std::string& plugin, const std::string& signature,
                                                           const SourceLocation& place) override;
  std::shared_ptr<const lang::NativeFunction> findSymbol(const std::string& symbol) override;

  /// The plugin of a file; errors at `place`.
  Result<std::shared_ptr<const NativePlugin>> open(const std::filesystem::path& file, const SourceLocation& place);

 private:
  std::vector<std::filesystem::path> folders_;
  std::filesystem::path checker_;
  std::mutex mutex_;
  std::map<std::filesystem::path, std::shared_ptr<const NativePlugin>> opened_;
};

/// Opens and initialises a shared object in this very process: what went wrong, or nothing. For the child process that
/// looks first.
std::string tryPlugin(const std::filesystem::path& file);

/// The shader that a plugin brings, with the plugin's functions declared in front of it.
Result<lang::CompiledSource> compilePlugin(const std::filesystem::path& file, const lang::CompileOptions& options);

}  // namespace aerosol::shading

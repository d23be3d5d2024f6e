#include "core/app/tools/shader_files.h"

#include <algorithm>
#include <array>

#include "core/shading/native_plugins.h"

namespace aerosol::app {

namespace fs = std::filesystem;

std::vector<fs::path> splitSearchPath(std::string_view text) {
  std::vector<fs::path> folders;
  while (!text.empty()) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    if (colon > 0) folders.emplace_back(text.substr(0, colon));
    text.remove_prefix(std::min(colon + 1, text.size()));
  }
  return folders;
}

std::optional<fs::path> findShaderFile(const std::string& name, const std::vector<fs::path>& folders) {
  constexpr std::array<const char*, 5> kinds = {"", "volume", "surface", "light", "texture"};
  std::vector<std::string> files = {name + ".oso", name + ".osl"};
  for (const char* extension : shading::pluginExtensions) files.push_back(name + extension);
  if (name.ends_with(".osl") || shading::isPluginFile(name)) files = {name};
  if (name.ends_with(".oso")) files = {name, name.substr(0, name.size() - 1) + "l"};
  for (const fs::path& folder : folders) {
    for (const char* kind : kinds) {
      for (const std::string& file : files) {
        const fs::path path = fs::path(file).is_absolute() ? fs::path(file) : folder / kind / file;
        std::error_code ignored;
        if (fs::is_regular_file(path, ignored)) return path;
      }
    }
  }
  return {};
}

}  // namespace aerosol::app

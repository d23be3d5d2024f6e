// Shaders by name for the tools: a compiled file comes before a source.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aerosol::app {

/// Folders between colons; empty ones are left out.
std::vector<std::filesystem::path> splitSearchPath(std::string_view text);

/// `name` with or without .oso or .osl (or .so and .bc of a plugin), in the first folder that has it (each also in its
/// subfolders of kinds of shaders). Without the extension, and in each folder, name.oso comes before name.osl. An empty
/// folder is the current one. Nothing when there is none.
std::optional<std::filesystem::path> findShaderFile(const std::string& name,
                                                    const std::vector<std::filesystem::path>& folders);

}  // namespace aerosol::app

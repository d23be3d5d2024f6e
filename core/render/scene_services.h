// Textures, voxel files and the like for one scene's shaders.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/shading/services.h"

namespace aerosol::render {

struct ServiceSettings {
  std::vector<std::filesystem::path> searchPath;  ///< For files that shaders name.
  int textureMemory_MB = 1024;
  ColorSettings colors = {};
};

std::unique_ptr<shading::Services> makeServices(ServiceSettings settings);

}  // namespace aerosol::render

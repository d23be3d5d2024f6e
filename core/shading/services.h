// What the host functions of a scene's shaders reach beyond the scene itself: textures, voxel files, points, colour
// spaces. The renderer makes it; libraries are loaded, and files opened, when the first shader asks.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "core/base/texture_source.h"
#include "core/base/voxel_grid.h"

namespace aerosol::shading {

/// Safe to use from any thread. What it gives stays valid as long as it does.
class Services {
 public:
  virtual ~Services() = default;

  /// Null, with a message, when the library cannot be loaded.
  virtual TextureSource* textures(std::string& problem) = 0;
  /// Whether a name is one of a voxel file.
  virtual bool isVoxelFile(std::string_view name) const = 0;
  /// Null, with a message, when the file cannot be read.
  virtual const VoxelFile* voxels(std::string_view name, std::string& problem) = 0;
};

/// The services as one thread uses them. Without services every question has the answer that there are none.
class ServicesOfThread {
 public:
  explicit ServicesOfThread(Services* services) : services_(services) {}

  TextureSession* textures(std::string& problem);
  bool isVoxelFile(std::string_view name) const { return services_ && services_->isVoxelFile(name); }
  const VoxelFile* voxels(std::string_view name, std::string& problem);

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };
  struct OpenVoxels {
    const VoxelFile* file = nullptr;
    std::string problem;
  };

  Services* services_;
  bool triedTextures_ = false;
  std::string textureProblem_;
  std::unique_ptr<TextureSession> textures_;
  std::unordered_map<std::string, OpenVoxels, Hash, std::equal_to<>> voxels_;
};

}  // namespace aerosol::shading

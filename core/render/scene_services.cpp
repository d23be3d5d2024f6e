#include "core/render/scene_services.h"

#include "core/grid/grid_file.h"
#include "core/image/textures.h"

namespace aerosol::render {

namespace {

/// Opens each file once, whoever asks first; others wait for that file alone.
class SceneServices final : public shading::Services {
 public:
  explicit SceneServices(ServiceSettings settings) : settings_(std::move(settings)) {}

  TextureSource* textures(std::string& problem) override {
    std::call_once(texturesOnce_, [&] {
      TextureSettings settings;
      for (const auto& folder : settings_.searchPath) settings.searchPath.push_back(folder.string());
      settings.memory_MB = settings_.textureMemory_MB;
      auto source = image::openTextures(settings);
      if (source) {
        textures_ = std::move(*source);
      } else {
        textureProblem_ = textOf(source.errors());
      }
    });
    problem = textureProblem_;
    return textures_.get();
  }

  bool isVoxelFile(std::string_view name) const override { return grid::isGridFile(name); }

  const VoxelFile* voxels(std::string_view name, std::string& problem) override {
    Voxels* entry = nullptr;
    {
      const std::lock_guard lock(mutex_);
      auto& slot = voxels_[std::string(name)];
      if (!slot) slot = std::make_unique<Voxels>();
      entry = slot.get();
    }
    std::call_once(entry->once, [&] {
      auto file = grid::readGrids(locate(name));
      if (file) {
        entry->file = std::move(*file);
      } else {
        entry->problem = "cannot read \"" + std::string(name) + "\": " + textOf(file.errors());
      }
    });
    problem = entry->problem;
    return entry->file.get();
  }

 private:
  struct Voxels {
    std::once_flag once;
    std::shared_ptr<const VoxelFile> file;
    std::string problem;
  };

  static std::string textOf(const Diagnostics& errors) {
    std::string text;
    for (const Diagnostic& error : errors.entries()) text += (text.empty() ? "" : "; ") + error.message;
    return text;
  }

  std::string locate(std::string_view name) const {
    const std::filesystem::path path(name);
    if (path.is_absolute()) return path.string();
    for (const auto& folder : settings_.searchPath) {
      std::error_code ignored;
      if (std::filesystem::is_regular_file(folder / path, ignored)) return (folder / path).string();
    }
    return path.string();
  }

  ServiceSettings settings_;
  std::once_flag texturesOnce_;
  std::unique_ptr<TextureSource> textures_;
  std::string textureProblem_;
  std::mutex mutex_;
  std::map<std::string, std::unique_ptr<Voxels>, std::less<>> voxels_;
};

}  // namespace

std::unique_ptr<shading::Services> makeServices(ServiceSettings settings) {
  return std::make_unique<SceneServices>(std::move(settings));
}

}  // namespace aerosol::render

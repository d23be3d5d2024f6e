#include "core/render/scene_services.h"

#include <fstream>

#include "core/accel/point_cloud.h"
#include "core/accel/point_writer.h"
#include "core/grid/grid_file.h"
#include "core/image/colors.h"
#include "core/image/pending_file.h"
#include "core/image/textures.h"
#include "core/scene/xml_dictionary.h"

namespace aerosol::render {

namespace {

/// Opens each file once, whoever asks first; others wait for that file alone.
class SceneServices final : public shading::Services {
 public:
  explicit SceneServices(ServiceSettings settings)
      : settings_(std::move(settings)), dictionaries_(scene::openDictionaries(settings_.searchPath)) {}

  TextureSource* textures(std::string& problem) override {
    std::call_once(texturesOnce_, [&] {
      TextureSettings settings;
      for (const auto& folder : settings_.searchPath) settings.searchPath.push_back(folder.string());
      settings.memory_MB = settings_.textureMemory_MB;
      settings.colors = settings_.colors;
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

  ColorSource* colors(std::string& problem) override {
    std::call_once(colorsOnce_, [&] {
      auto source = image::openColors(settings_.colors);
      if (source) {
        colors_ = std::move(*source);
      } else {
        colorProblem_ = textOf(source.errors());
      }
    });
    problem = colorProblem_;
    return colors_.get();
  }

  DictionarySource* dictionaries() override { return dictionaries_.get(); }

  bool isVoxelFile(std::string_view name) const override { return grid::isGridFile(name); }

  const PointCloud* points(std::string_view name, std::string& problem) override {
    return open(points_, name, accel::readPoints, problem);
  }

  bool writePoint(std::string_view name, std::vector<PointAttribute> point, std::string& problem) override {
    accel::PointWriter* writer = nullptr;
    {
      const std::lock_guard lock(mutex_);
      auto& slot = writers_[std::string(name)];
      if (!slot) slot = std::make_unique<accel::PointWriter>();
      writer = slot.get();
    }
    return writer->add(std::move(point), problem);
  }

  Diagnostics finish() override {
    const std::lock_guard lock(mutex_);
    Diagnostics errors;
    for (const auto& [name, writer] : writers_) {
      std::string problem;
      const auto content = writer->encode(std::filesystem::path(name).extension().string(), problem);
      if (!content) {
        errors.error({name, 0, 0}, problem);
        continue;
      }
      auto file = image::PendingFile::create(name);
      if (!file) {
        errors.append(file.errors());
      } else if (std::ofstream stream(file->path(), std::ios::binary); !(stream << *content).flush()) {
        errors.error({name, 0, 0}, "cannot write the file");
      } else {
        stream.close();
        errors.append(file->commit());
      }
    }
    writers_.clear();
    return errors;
  }

  const VoxelFile* voxels(std::string_view name, std::string& problem) override {
    return open(voxels_, name, grid::readGrids, problem);
  }

 private:
  template <class File>
  struct Opened {
    std::once_flag once;
    std::shared_ptr<const File> file;
    std::string problem;
  };
  template <class File>
  using Files = std::map<std::string, std::unique_ptr<Opened<File>>, std::less<>>;

  template <class File>
  const File* open(Files<File>& files, std::string_view name,
                   Result<std::shared_ptr<const File>> (*read)(const std::string&), std::string& problem) {
    Opened<File>* entry = nullptr;
    {
      const std::lock_guard lock(mutex_);
      auto& slot = files[std::string(name)];
      if (!slot) slot = std::make_unique<Opened<File>>();
      entry = slot.get();
    }
    std::call_once(entry->once, [&] {
      auto file = read(locate(name));
      if (file) {
        entry->file = std::move(*file);
      } else {
        entry->problem = "cannot read \"" + std::string(name) + "\": " + textOf(file.errors());
      }
    });
    problem = entry->problem;
    return entry->file.get();
  }

  static std::string textOf(const Diagnostics& errors) {
    std::string text;
    for (const Diagnostic& error : errors.entries()) text += (text.empty() ? "" : "; ") + error.message;
    return text;
  }

  std::string locate(std::string_view name) const {
    const std::filesystem::path path(grid::fileOfName(name));
    const std::string rest(name.substr(path.native().size()));
    if (path.is_absolute()) return path.string() + rest;
    for (const auto& folder : settings_.searchPath) {
      std::error_code ignored;
      if (std::filesystem::is_regular_file(folder / path, ignored)) return (folder / path).string() + rest;
    }
    return path.string() + rest;
  }

  ServiceSettings settings_;
  std::once_flag texturesOnce_;
  std::unique_ptr<TextureSource> textures_;
  std::string textureProblem_;
  std::once_flag colorsOnce_;
  std::unique_ptr<ColorSource> colors_;
  std::string colorProblem_;
  std::unique_ptr<DictionarySource> dictionaries_;
  std::mutex mutex_;
  Files<VoxelFile> voxels_;
  Files<PointCloud> points_;
  std::map<std::string, std::unique_ptr<accel::PointWriter>> writers_;
};

}  // namespace

std::unique_ptr<shading::Services> makeServices(ServiceSettings settings) {
  return std::make_unique<SceneServices>(std::move(settings));
}

}  // namespace aerosol::render

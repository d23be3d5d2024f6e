// What the host functions of a scene's shaders reach beyond the scene itself: textures, voxel files, points, colour
// spaces. The renderer makes it; libraries are loaded, and files opened, when the first shader asks.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/base/color_source.h"
#include "core/base/dictionary_source.h"
#include "core/base/point_cloud.h"
#include "core/base/result.h"
#include "core/base/texture_source.h"
#include "core/base/voxel_grid.h"

namespace aerosol::shading {

/// Safe to use from any thread. What it gives stays valid as long as it does.
class Services {
 public:
  virtual ~Services() = default;

  /// Null, with a message, when the library cannot be loaded.
  virtual TextureSource* textures(std::string& problem) = 0;
  /// Null, with a message, when the library cannot be loaded or the configuration cannot be read.
  virtual ColorSource* colors(std::string& problem) = 0;
  /// Whether a name is one of a voxel file.
  virtual bool isVoxelFile(std::string_view name) const = 0;
  /// Null, with a message, when the file cannot be read.
  virtual const VoxelFile* voxels(std::string_view name, std::string& problem) = 0;
  /// Null, with a message, when the file cannot be read.
  virtual const PointCloud* points(std::string_view name, std::string& problem) = 0;
  /// A point for a cloud that is saved in the end (see accel::PointWriter). False, with a message, when it is refused.
  virtual bool writePoint(std::string_view name, std::vector<PointAttribute> point, std::string& problem) = 0;
  /// Saves the clouds that were written.
  virtual Diagnostics finish() = 0;
  /// Null when there are none.
  virtual DictionarySource* dictionaries() = 0;
};

/// The services as one thread uses them. Without services every question has the answer that there are none.
class ServicesOfThread {
 public:
  explicit ServicesOfThread(Services* services) : services_(services) {}

  TextureSession* textures(std::string& problem);
  bool isVoxelFile(std::string_view name) const { return services_ && services_->isVoxelFile(name); }
  const VoxelFile* voxels(std::string_view name, std::string& problem) {
    return find(voxels_, &Services::voxels, name, problem);
  }
  const PointCloud* points(std::string_view name, std::string& problem) {
    return find(points_, &Services::points, name, problem);
  }
  bool writePoint(std::string_view name, std::vector<PointAttribute> point, std::string& problem);
  /// As ColorSource::between.
  const ColorTransform* colors(std::string_view from, std::string_view to, std::string& problem);
  DictionarySource* dictionaries() { return services_ ? services_->dictionaries() : nullptr; }

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };
  template <class File>
  struct Opened {
    const File* file = nullptr;
    std::string problem;
  };
  template <class File>
  using Files = std::unordered_map<std::string, Opened<File>, Hash, std::equal_to<>>;

  /// What the services said, asked once for each name.
  template <class File>
  const File* find(Files<File>& files, const File* (Services::*open)(std::string_view, std::string&),
                   std::string_view name, std::string& problem) {
    auto known = files.find(name);
    if (known == files.end()) {
      Opened<File> opened;
      opened.problem = noServices;
      if (services_) opened.file = (services_->*open)(name, opened.problem);
      known = files.emplace(std::string(name), std::move(opened)).first;
    }
    problem = known->second.problem;
    return known->second.file;
  }
  static constexpr const char* noServices = "there are no files here";

  Services* services_;
  bool triedTextures_ = false;
  std::string textureProblem_;
  std::unique_ptr<TextureSession> textures_;
  Files<VoxelFile> voxels_;
  Files<PointCloud> points_;
};

}  // namespace aerosol::shading

#include "core/app/file_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>
#include <tuple>

#include "core/lang/voxel_reads.h"
#include "core/shading/instance_values.h"
#include "core/shading/voxel_functions.h"

namespace aerosol::app {

namespace {

namespace fs = std::filesystem;

enum class FileKind { none, texture, points };

FileKind kindOf(const std::string& name) {
  static constexpr std::array<std::string_view, 17> textures{".exr", ".png", ".jpg", ".jpeg", ".tif", ".tiff",
                                                             ".tx",  ".hdr", ".tga", ".bmp",  ".ppm", ".pgm",
                                                             ".pfm", ".vdb", ".vol", ".avt",  ".webp"};
  static constexpr std::array<std::string_view, 2> points{".ply", ".csv"};
  // Frames and UDIM sets: which files they are depends on what is asked for.
  if (name.find('%') != std::string::npos || name.find('<') != std::string::npos) return FileKind::none;
  const std::string extension = fs::path(name).extension().string();
  const auto isOne = [&](const auto& known) { return std::ranges::find(known, extension) != known.end(); };
  return isOne(textures) ? FileKind::texture : isOne(points) ? FileKind::points : FileKind::none;
}

/// Without the words that only repeat the name: `cannot read "NAME": `.
std::string shorten(const std::string& problem) {
  const std::size_t colon = problem.starts_with("cannot read") ? problem.find("\": ") : std::string::npos;
  return colon == std::string::npos ? problem : problem.substr(colon + 3);
}

class FileCheck {
 public:
  FileCheck(const scene::SceneDescription& description, const render::PreparedScene& scene)
      : description_(description), scene_(scene), services_(*scene.services) {}

  Diagnostics run() {
    for (std::size_t i = 0; i < scene_.media.size(); ++i)
      checkVoxels(scene_.mediumShaders[i], scene_.mediumLocations[i]);
    for (std::size_t i = 0; i < scene_.objects.size(); ++i)
      checkVoxels(scene_.objects[i].material, description_.shapes[i].origin.location);
    for (const scene::ShaderUse& use : description_.materials) check(use);
    for (const scene::Medium& medium : description_.media) check(medium.shader);
    for (const scene::Displacement& displacement : description_.displacements) check(displacement.shader);
    for (const scene::ShaderUse& use : description_.layers) check(use);
    return std::move(found_);
  }

 private:
  /// What the shader reads wherever it runs has to be there: nobody wants the picture without.
  void checkVoxels(shading::InstanceRef shader, const SourceLocation& place) {
    const shading::Family& family = scene_.shading.family(shader);
    const auto values = shading::valuesOf(*family.program, family.instances[shader.index]);
    for (const lang::VoxelRead& read : lang::findVoxelReads(*family.program, values)) {
      if (!services_.isVoxelFile(read.file) || !toldReads_.emplace(read.file, read.grid, read.number).second) continue;
      std::string problem;
      const VoxelFile* const file = services_.voxels(read.file, problem);
      const SourceLocation& at = family.program->locations[read.location];
      const std::string call =
          fmt::format("shader '{}' reads it at {}:{}:{}", family.program->name, at.file, at.line, at.column);
      if (!file) {
        const std::string cure = isThere(read.file) ? "write the file anew" : missing();
        if (told_.insert(read.file).second)
          found_.error(placeOf(read.file, place), fmt::format("\"{}\": {}", read.file, shorten(problem)), {call, cure});
        continue;
      }
      TexturePoint point;
      point.subimageName = read.grid;
      point.subimage = read.number;
      if (shading::chooseVoxelGrid(*file, read.file, point, problem)) continue;
      found_.error(placeOf(read.grid.empty() ? read.file : read.grid, place), problem,
                   {call, "'aerosol info' lists the grids of a file"});
    }
  }

  /// Where the scene gives this text to a shader; `place` where it does not, because it is a default.
  SourceLocation placeOf(const std::string& text, const SourceLocation& place) const {
    const auto find = [&](const scene::ShaderUse& use) -> const SourceLocation* {
      for (const scene::ShaderParameter& parameter : use.parameters) {
        const auto* const value = std::get_if<std::string>(&parameter.value);
        if (value && *value == text) return &parameter.valueLocation;
      }
      return nullptr;
    };
    for (const scene::Medium& medium : description_.media)
      if (const SourceLocation* at = find(medium.shader)) return *at;
    for (const auto* uses : {&description_.materials, &description_.layers}) {
      for (const scene::ShaderUse& use : *uses)
        if (const SourceLocation* at = find(use)) return *at;
    }
    return place;
  }

  void check(const scene::ShaderUse& use) {
    for (const scene::ShaderParameter& parameter : use.parameters) {
      const auto* const name = std::get_if<std::string>(&parameter.value);
      if (!name || !told_.insert(*name).second) continue;
      const std::string problem = problemOf(*name);
      if (problem.empty()) continue;
      found_.warning(parameter.valueLocation,
                     fmt::format("\"{}\" of shader '{}' cannot be read: {}", *name, use.name, problem),
                     {isThere(*name) ? "write the file anew, in a format that is known" : missing()});
    }
  }

  std::string problemOf(const std::string& name) {
    std::string problem;
    const FileKind kind = kindOf(name);
    if (kind == FileKind::none) return problem;
    if (kind == FileKind::points) {
      services_.points(name, problem);
      problem = shorten(problem);
    } else if (services_.isVoxelFile(name)) {
      services_.voxels(name, problem);
      problem = shorten(problem);
    } else if (TextureSource* const textures = services_.textures(problem)) {
      std::vector<TextureFailure> failures;
      const TexturePoint point;
      float texel = 0;
      textures->openSession()->lookup(TextureKind::plane, name, {&point, 1}, 1, &texel, failures);
      if (!failures.empty()) problem = isThere(name) ? shorten(failures.front().message) : "there is no such file";
    }
    return problem;
  }

  bool isThere(const std::string& name) const {
    std::error_code ignored;
    if (fs::exists(name, ignored)) return true;
    return std::ranges::any_of(description_.searchPath,
                               [&](const fs::path& folder) { return fs::exists(folder / name, ignored); });
  }

  std::string missing() const {
    std::string text = "correct the name, or put the file where it is looked for: ";
    const std::size_t start = text.size();
    for (const fs::path& folder : description_.searchPath) {
      text += fmt::format("{}'{}'", text.size() == start ? "" : ", ", folder.empty() ? "." : folder.string());
    }
    return text + (text.size() == start ? "" : ", ") + "and where shaders are";
  }

  const scene::SceneDescription& description_;
  const render::PreparedScene& scene_;
  shading::Services& services_;
  std::set<std::string> told_;
  std::set<std::tuple<std::string, std::string, int>> toldReads_;
  Diagnostics found_;
};

}  // namespace

Diagnostics examineFiles(const scene::SceneDescription& description, const render::PreparedScene& scene) {
  return scene.services ? FileCheck(description, scene).run() : Diagnostics();
}

}  // namespace aerosol::app

#include "core/app/file_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>

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
      : description_(description), services_(*scene.services) {}

  Diagnostics run() {
    for (const scene::ShaderUse& use : description_.materials) check(use);
    for (const scene::Medium& medium : description_.media) check(medium.shader);
    for (const scene::Displacement& displacement : description_.displacements) check(displacement.shader);
    for (const scene::ShaderUse& use : description_.layers) check(use);
    return std::move(found_);
  }

 private:
  void check(const scene::ShaderUse& use) {
    for (const scene::ShaderParameter& parameter : use.parameters) {
      const auto* const name = std::get_if<std::string>(&parameter.value);
      if (!name || !told_.insert(*name).second) continue;
      const std::string problem = problemOf(*name);
      if (problem.empty()) continue;
      found_.warning(parameter.valueLocation,
                     fmt::format("\"{}\" of shader '{}' cannot be read: {}", *name, use.name, problem),
                     {isThere(*name) ? "write the file anew, in a format that is known"
                                     : "correct the name, or put the file where it is looked for: " + folders()});
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

  std::string folders() const {
    std::string text;
    for (const fs::path& folder : description_.searchPath) {
      text += fmt::format("{}'{}'", text.empty() ? "" : ", ", folder.empty() ? "." : folder.string());
    }
    return text + (text.empty() ? "" : ", ") + "and where shaders are";
  }

  const scene::SceneDescription& description_;
  shading::Services& services_;
  std::set<std::string> told_;
  Diagnostics found_;
};

}  // namespace

Diagnostics examineFiles(const scene::SceneDescription& description, const render::PreparedScene& scene) {
  return scene.services ? FileCheck(description, scene).run() : Diagnostics();
}

}  // namespace aerosol::app

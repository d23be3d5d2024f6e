#include "core/scene/loader.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "core/scene/meaning.h"
#include "core/scene/overrides.h"
#include "core/scene/reporter.h"
#include "core/scene/syntax.h"

namespace aerosol::scene {

Result<SceneDescription> load(const std::filesystem::path& path, const LoadOptions& options, Diagnostics& warnings) {
  std::string why;
  std::optional<std::string> text = readFile(path, why);
  if (!text) {
    Diagnostics errors;
    errors.error({path.string(), 0, 0}, fmt::format("the scene cannot be read: {}", why));
    return errors;
  }
  return loadString(std::move(*text), path.string(), path.parent_path(), options, warnings);
}

Result<SceneDescription> loadString(std::string text, const std::string& name, const std::filesystem::path& directory,
                                    const LoadOptions& options, Diagnostics& warnings) {
  auto sources = std::make_shared<SourceTexts>();
  Reporter reporter;
  const SourceText& root = sources->add(name, std::move(text), directory);
  const SceneTree tree = readTree(root, options.defines, *sources, reporter);
  // Without one element below the root there is nothing to check: the file could not be read, or that is the error.
  SceneDescription scene;
  if (!tree.scene.children.empty() || !reporter.failed()) {
    scene = describeScene(tree, options.knownTypes, *sources, reporter);
  }
  scene.searchPath = tree.searchPath;
  scene.searchPath.insert(scene.searchPath.begin(), directory.empty() ? std::filesystem::path(".") : directory);
  scene.sources = sources;
  if (!reporter.failed()) {
    for (const std::string& assignment : options.overrides) {
      applyOverride(scene, assignment, options.knownTypes, reporter);
    }
  }
  reporter.sort();
  sources->annotate(reporter.warnings());
  warnings.append(reporter.warnings());
  if (!reporter.failed()) return scene;
  sources->annotate(reporter.errors());
  return std::move(reporter.errors());
}

}  // namespace aerosol::scene

#include "core/scene/loader.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "core/scene/meaning.h"
#include "core/scene/overrides.h"
#include "core/scene/reporter.h"
#include "core/scene/syntax.h"

namespace aerosol::scene {

namespace {

Reading readText(std::string text, const std::string& name, const std::filesystem::path& directory,
                 const LoadOptions& options, Diagnostics& warnings) {
  auto sources = std::make_shared<SourceTexts>();
  Reporter reporter;
  const SourceText& root = sources->add(name, std::move(text), directory);
  const SceneTree tree = readTree(root, options.defines, *sources, reporter);
  Reading reading;
  // Without one element below the root there is nothing to check: the file could not be read, or that is the error.
  if (!tree.scene.children.empty() || !reporter.failed()) {
    reading.scene = describeScene(tree, options.knownTypes, *sources, options.sensor, reporter);
    reading.scene->searchPath = tree.searchPath;
    reading.scene->searchPath.insert(reading.scene->searchPath.begin(),
                                     directory.empty() ? std::filesystem::path(".") : directory);
    reading.scene->sources = sources;
  }
  if (!reporter.failed()) {
    for (const std::string& assignment : options.overrides) {
      applyOverride(*reading.scene, assignment, options.knownTypes, reporter);
    }
  }
  reporter.sort();
  sources->annotate(reporter.warnings());
  warnings.append(reporter.warnings());
  sources->annotate(reporter.errors());
  reading.errors = std::move(reporter.errors());
  return reading;
}

Result<SceneDescription> whole(Reading reading) {
  if (reading.errors.hasErrors()) return std::move(reading.errors);
  return std::move(*reading.scene);
}

}  // namespace

Reading read(const std::filesystem::path& path, const LoadOptions& options, Diagnostics& warnings) {
  std::string why;
  std::optional<std::string> text = readFile(path, why);
  if (text) return readText(std::move(*text), path.string(), path.parent_path(), options, warnings);
  Reading nothing;
  nothing.errors.error({path.string(), 0, 0}, fmt::format("the scene cannot be read: {}", why));
  return nothing;
}

Result<SceneDescription> load(const std::filesystem::path& path, const LoadOptions& options, Diagnostics& warnings) {
  return whole(read(path, options, warnings));
}

Result<SceneDescription> loadString(std::string text, const std::string& name, const std::filesystem::path& directory,
                                    const LoadOptions& options, Diagnostics& warnings) {
  return whole(readText(std::move(text), name, directory, options, warnings));
}

}  // namespace aerosol::scene

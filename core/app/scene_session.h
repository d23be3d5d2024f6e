// From a scene file to a scene that can be rendered, with what the command line changes: what all commands that render
// begin with.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/statistics_report.h"
#include "core/app/toolchain.h"
#include "core/render/prepare.h"
#include "core/render/registry.h"

namespace aerosol::app {

/// Steps that fail have told why on the console.
class SceneSession {
 public:
  SceneSession(const RenderArguments& arguments, const Console& console);

  /// Reads the scene and applies the arguments, but for the crop.
  bool load();
  /// Compiles shaders and builds all that rendering needs.
  bool prepare();
  /// Prepares again, as `description()` has become; what is to be said of it has been said.
  bool prepareAgain();
  /// In place of the two: everything that is wrong with the scene, told by nobody yet, like its warnings.
  Diagnostics check();
  /// The same scene with another description; null after errors. Warnings are those of `prepare` and not repeated.
  std::unique_ptr<const render::PreparedScene> prepareVariant(const scene::SceneDescription& description);

  /// The files that the scene was read from, as far as reading came: its own, shaders with what they include, plugins.
  std::set<std::string> files() const;

  const render::Registry& registry() const { return registry_; }
  scene::SceneDescription& description() { return *description_; }
  const scene::SceneDescription& description() const { return *description_; }
  const render::PreparedScene& scene() const { return *scene_; }
  const render::Integrator& integrator() const { return *registry_.integrator(description_->integrator.type); }
  const jit::ObjectCache* cache() const { return toolchain_ ? toolchain_->cache.get() : nullptr; }
  jit::Target target() const { return toolchain_->target; }
  const PreparationTimes& times() const { return times_; }
  int threadCount() const;
  /// What is wrong with files that shaders name; a part of `warnings`.
  const Diagnostics& fileWarnings() const { return files_; }
  /// What was doubtful while loading and preparing.
  const Diagnostics& warnings() const { return warnings_; }

 private:
  render::PrepareOptions prepareOptions() const;
  Diagnostics findFiles(const render::PreparedScene& scene) const;
  Diagnostics findMedia(const render::PreparedScene& scene) const;
  bool accept(const Diagnostics& diagnostics) const;
  void tellWarnings(const Diagnostics& warnings);

  const RenderArguments& arguments_;
  const Console& console_;
  render::Registry registry_;
  std::optional<scene::SceneDescription> description_;
  std::optional<Toolchain> toolchain_;
  std::optional<render::SamplingPlan> plan_;
  std::unique_ptr<const render::PreparedScene> scene_;
  PreparationTimes times_;
  Diagnostics warnings_, files_;
};

/// Narrows the film to the crop. An error when that does not lie within the film.
Diagnostics applyCrop(const std::optional<Crop>& crop, scene::Film& film);

}  // namespace aerosol::app

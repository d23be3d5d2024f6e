#include "core/app/scene_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/app/file_check.h"
#include "core/app/plan/effects.h"
#include "core/app/registered_types.h"
#include "core/app/sampling_plan_file.h"
#include "core/app/shader_report.h"
#include "core/lang/native.h"
#include "core/render/scene_check.h"
#include "core/scene/loader.h"
#include "plugins/registration.h"

namespace aerosol::app {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void applyArguments(const RenderArguments& arguments, scene::SceneDescription& description) {
  if (arguments.samplesPerPixel) description.sampler.sampleCount = *arguments.samplesPerPixel;
  if (arguments.seed) description.sampler.seed = *arguments.seed;
  if (arguments.stepScale) description.integrator.stepScale = *arguments.stepScale;
  if (arguments.transmittance) {
    description.integrator.transmittance = *arguments.transmittance;
    for (scene::Medium& medium : description.media) medium.sampling.transmittance.reset();
    for (scene::Volume& volume : description.volumes) volume.sampling.transmittance.reset();
  }
  if (arguments.noEquiangular) description.integrator.equiangular = false;
  if (arguments.jointLights) description.integrator.jointLights = true;
  if (!arguments.distance) return;
  description.integrator.distance = *arguments.distance;
  for (scene::Medium& medium : description.media) medium.sampling.distance.reset();
  for (scene::Volume& volume : description.volumes) volume.sampling.distance.reset();
}

}  // namespace

SceneSession::SceneSession(const RenderArguments& arguments, const Console& console)
    : arguments_(arguments), console_(console) {
  render::registerPlugins(registry_);
}

bool SceneSession::accept(const Diagnostics& diagnostics) const {
  console_.report(diagnostics);
  return !diagnostics.hasErrors();
}

void SceneSession::tellWarnings(const Diagnostics& warnings) {
  console_.report(warnings);
  warnings_.append(warnings);
}

bool SceneSession::load() {
  const Clock::time_point start = Clock::now();
  Diagnostics warnings;
  auto loaded =
      scene::load(arguments_.scene,
                  {arguments_.defines, arguments_.overrides, registeredTypes(registry_), arguments_.sensor}, warnings);
  tellWarnings(warnings);
  if (!loaded) return accept(loaded.errors());
  description_ = std::move(*loaded);
  times_.load = secondsSince(start);
  applyArguments(arguments_, *description_);
  return accept(removeEffects(arguments_.without, *description_));
}

bool SceneSession::prepare() {
  const Clock::time_point start = Clock::now();
  Diagnostics warnings;
  auto toolchain = openToolchain(arguments_.kernels, warnings);
  tellWarnings(warnings);
  if (!toolchain) return accept(toolchain.errors());
  toolchain_ = std::move(*toolchain);
  if (!arguments_.plan.empty()) {
    auto plan = readSamplingPlan(arguments_.plan);
    if (!plan) return accept(plan.errors());
    plan_ = std::move(*plan);
  }
  scene_ = prepareVariant(*description_);
  if (scene_) {
    files_ = findFiles(*scene_);
    tellWarnings(files_);
    if (files_.hasErrors()) scene_ = nullptr;
  }
  times_.prepare = secondsSince(start);
  return scene_ != nullptr;
}

Diagnostics SceneSession::findFiles(const render::PreparedScene& scene) const {
  Diagnostics files = examineFiles(*description_, scene);
  description_->sources->annotate(files);
  return files;
}

/// What media that are the same everywhere give, that they should not.
Diagnostics SceneSession::findMedia(const render::PreparedScene& scene) const {
  Diagnostics media = reportInvalidCoefficients(scene);
  media.append(reportAmplifyingMedia(scene));
  description_->sources->annotate(media);
  return media;
}

bool SceneSession::prepareAgain() {
  auto scene = prepareVariant(*description_);
  if (scene) scene_ = std::move(scene);
  return scene_ != nullptr;
}

Diagnostics SceneSession::check() {
  scene::Reading reading =
      scene::read(arguments_.scene,
                  {arguments_.defines, arguments_.overrides, registeredTypes(registry_), arguments_.sensor}, warnings_);
  Diagnostics errors = std::move(reading.errors);
  auto toolchain = openToolchain(arguments_.kernels, warnings_);
  if (!toolchain) errors.append(toolchain.errors());
  if (!toolchain || !reading.scene) return errors;
  toolchain_ = std::move(*toolchain);
  description_ = std::move(*reading.scene);
  applyArguments(arguments_, *description_);
  errors.append(removeEffects(arguments_.without, *description_));
  if (!errors.hasErrors()) {
    auto prepared = render::prepare(*description_, registry_, prepareOptions(), warnings_);
    if (prepared) {
      const Diagnostics files = findFiles(**prepared);
      for (const Diagnostic& found : files.entries())
        (found.severity == Severity::error ? errors : warnings_).add(found);
      warnings_.append(findMedia(**prepared));
      return errors;
    }
    errors.append(prepared.errors());
  }
  const Diagnostics parts = render::checkParts(*description_, registry_, prepareOptions());
  for (const Diagnostic& found : parts.entries()) {
    const bool isKnown = std::any_of(errors.entries().begin(), errors.entries().end(), [&](const Diagnostic& e) {
      return e.location == found.location && e.message == found.message;
    });
    if (!isKnown) errors.add(found);
  }
  return errors;
}

render::PrepareOptions SceneSession::prepareOptions() const {
  render::PrepareOptions options;
  options.shaderPath = arguments_.kernels.shaderPath;
  options.shaderLibrary = toolchain_->installation.shaders;
  options.plugins = toolchain_->installation.plugins;
  options.compiler = toolchain_->compiler;
  options.cache = toolchain_->cache;
  options.target = toolchain_->target;
  options.embreeIsa = arguments_.kernels.isa;
  options.laneCounters = arguments_.countLanes;
  options.textureMemory_MB = arguments_.textureMemory_MB;
  options.colors = {arguments_.display.config, arguments_.display.workingSpace};
  options.threads = threadCount();
  options.plan = plan_;
  options.loopBudget = static_cast<std::uint32_t>(arguments_.loopBudget);
  const auto isLeftOut = [&](const char* effect) {
    return std::ranges::find(arguments_.without, effect) != arguments_.without.end();
  };
  if (!isLeftOut("layers")) options.aovs = arguments_.aovs;
  options.deepSlices = arguments_.deep.file.empty() || isLeftOut("deep-output") ? 0 : arguments_.deep.slices;
  return options;
}

std::unique_ptr<const render::PreparedScene> SceneSession::prepareVariant(const scene::SceneDescription& description) {
  Diagnostics warnings;
  auto prepared = render::prepare(description, registry_, prepareOptions(), warnings);
  if (!scene_) tellWarnings(warnings);
  if (!prepared) {
    accept(prepared.errors());
    return nullptr;
  }
  return std::move(*prepared);
}

std::set<std::string> SceneSession::files() const {
  std::set<std::string> names = {arguments_.scene.string()};
  if (description_) {
    for (const auto& [name, text] : description_->sources->all()) names.insert(name);
  }
  if (!scene_) return names;
  for (const shading::Family& family : scene_->shading.families()) {
    for (const SourceLocation& place : family.program->locations) names.insert(place.file);
    for (const lang::FunctionUse& function : family.program->functions)
      if (const auto native = lang::parseNativeSymbol(function.symbol)) names.insert(native->file.string());
  }
  return names;
}

int SceneSession::threadCount() const {
  return arguments_.threads > 0 ? arguments_.threads
                                : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

Diagnostics applyCrop(const std::optional<Crop>& asked, scene::Film& film) {
  Diagnostics errors;
  if (!asked) return errors;
  const Crop& crop = *asked;
  if (crop.width > film.width - crop.x || crop.height > film.height - crop.y) {
    errors.error({}, fmt::format("--crop {},{},{},{} reaches beyond the film of {} x {} pixels", crop.x, crop.y,
                                 crop.width, crop.height, film.width, film.height));
    return errors;
  }
  film.cropOffsetX = crop.x;
  film.cropOffsetY = crop.y;
  film.cropWidth = crop.width;
  film.cropHeight = crop.height;
  return errors;
}

}  // namespace aerosol::app

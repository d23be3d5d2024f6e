#include "core/render/preparation/contributions.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/base/hash.h"
#include "core/render/medium_facts.h"
#include "core/render/renderer.h"

namespace aerosol::render {

namespace {

/// Of the pilot: of each pixel of a picture of no more than these.
constexpr std::uint32_t pilotSampleCount = 2;
constexpr double mostPixels = 2048;
/// A smaller picture costs less than its pilot would.
constexpr double fewestPixels = 1024;
/// Paths that get no longer gain nothing.
constexpr int shortDepth = 4;

/// What a shader says by itself. What is reported of it (a loop over its budget, say) is no message.
bool isMessage(const jit::MessageSite& site) {
  return site.kind == AEROSOL_MESSAGE_PRINT || site.kind == AEROSOL_MESSAGE_WARNING ||
         site.kind == AEROSOL_MESSAGE_ERROR || site.kind == AEROSOL_MESSAGE_FILE;
}

/// Shaders that do something beside what they give would do it twice.
bool hasSideEffects(const PreparedScene& scene) {
  for (const shading::Family& family : scene.shading.families()) {
    for (const lang::FunctionUse& use : family.program->functions) {
      if (use.symbol.find("pointcloud_write") != std::string::npos) return true;
    }
    for (const auto& kernel : family.kernels) {
      if (kernel && std::ranges::any_of(kernel->interface().sites, isMessage)) return true;
    }
  }
  return false;
}

bool isCalledFor(const Preparation& state, double pixels) {
  const scene::Integrator& integrator = state.description.integrator;
  if (integrator.roulette == scene::Roulette::throughput || integrator.type != "path") return false;
  if (hasSideEffects(*state.scene)) return false;
  if (mostStepsAcross(*state.scene) > endlessSteps) return false;  // The pilot would not come to an end, either.
  if (integrator.roulette == scene::Roulette::contribution) return true;
  const bool plays = integrator.rrDepth < std::numeric_limits<int>::max();
  const bool isLong = integrator.maxDepth < 0 || integrator.maxDepth > shortDepth;
  return plays && isLong && pixels >= fewestPixels &&
         std::ranges::any_of(state.scene->media, &volume::Medium::mayScatter);
}

}  // namespace

void learnContributions(Preparation& state) {
  scene::Film film = state.description.film;
  const int filmWidth = film.width, filmHeight = film.height;
  const double pixels = static_cast<double>(filmWidth) * filmHeight;
  if (!hasOptionalEffects || !isCalledFor(state, pixels)) return;
  const Integrator* const integrator = state.registry.integrator(state.description.integrator.type);
  if (!integrator) return;
  const double scale = std::min(1.0, std::sqrt(mostPixels / pixels));
  film.width = std::max(1, static_cast<int>(filmWidth * scale));
  film.height = std::max(1, static_cast<int>(filmHeight * scale));
  film.cropOffsetX = film.cropOffsetY = 0;
  film.cropWidth = film.width;
  film.cropHeight = film.height;

  PreparedScene& scene = *state.scene;
  std::optional<Camera> camera(std::in_place, state.description.sensor, film);
  auto messages = std::make_unique<MessageLog>();
  std::swap(scene.camera, camera);
  std::swap(scene.messages, messages);
  PilotLog log;
  Film picture(PixelRect{0, 0, film.width, film.height});
  RenderOptions options;
  options.threads = state.options.threads;
  options.endSample = pilotSampleCount;
  options.seed = combineHashes(scene.seed, hashString("pilot of contributions"));
  options.pilot = &log;
  render(scene, *integrator, picture, options);
  std::swap(scene.camera, camera);
  std::swap(scene.messages, messages);
  scene.contributions = ContributionMap(std::move(log.paths), film.width, film.height, filmWidth, filmHeight);
}

}  // namespace aerosol::render

#include "core/app/render_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "core/app/interrupt.h"
#include "core/app/output_files.h"
#include "core/app/picture.h"
#include "core/app/progress.h"
#include "core/app/quantity.h"
#include "core/app/registered_types.h"
#include "core/app/shader_report.h"
#include "core/app/statistics_report.h"
#include "core/app/toolchain.h"
#include "core/render/prepare.h"
#include "core/render/renderer.h"
#include "core/scene/loader.h"
#include "plugins/registration.h"

namespace aerosol::app {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// What the arguments change in a scene. An error when the crop does not lie within the film.
Diagnostics applyArguments(const RenderArguments& arguments, scene::SceneDescription& description) {
  Diagnostics errors;
  if (arguments.samplesPerPixel) description.sampler.sampleCount = *arguments.samplesPerPixel;
  if (arguments.seed) description.sampler.seed = *arguments.seed;
  if (arguments.stepScale) description.integrator.stepScale = *arguments.stepScale;
  if (arguments.distance) {
    description.integrator.distance = *arguments.distance;
    for (scene::Medium& medium : description.media) medium.sampling.distance.reset();
    for (scene::Volume& volume : description.volumes) volume.sampling.distance.reset();
  }
  if (!arguments.crop) return errors;
  const Crop& crop = *arguments.crop;
  scene::Film& film = description.film;
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

/// One run of the command, step by step. A step that fails has told why.
class Render {
 public:
  Render(const RenderArguments& arguments, const Console& console)
      : arguments_(arguments), console_(console), watch_(console) {
    render::registerPlugins(registry_);
  }

  ExitCode run() {
    outputs_ = outputNames(arguments_.outputs, arguments_.scene);
    if (!accept(checkOutputNames(outputs_))) return ExitCode::usage;
    if (!accept(checkOutputPlaces(outputs_)) || !load() || !prepare()) return ExitCode::badInput;
    if (!accept(tryOutputs(outputs_, description_->film))) return ExitCode::badInput;
    renderFilm();
    const bool isWritten = write();
    tell();
    if (!isWritten) return ExitCode::badInput;
    return report_.interrupted ? ExitCode::interrupted : ExitCode::success;
  }

 private:
  bool accept(const Diagnostics& diagnostics) {
    console_.report(diagnostics);
    return !diagnostics.hasErrors();
  }

  bool load() {
    const Clock::time_point start = Clock::now();
    Diagnostics warnings;
    auto loaded =
        scene::load(arguments_.scene, {arguments_.defines, arguments_.overrides, registeredTypes(registry_)}, warnings);
    console_.report(warnings);
    if (!loaded) return accept(loaded.errors());
    description_ = std::move(*loaded);
    times_.load = secondsSince(start);
    return accept(applyArguments(arguments_, *description_));
  }

  bool prepare() {
    const Clock::time_point start = Clock::now();
    Diagnostics warnings;
    auto toolchain = openToolchain(arguments_.kernels, warnings);
    if (!toolchain) {
      console_.report(warnings);
      return accept(toolchain.errors());
    }
    render::PrepareOptions options;
    options.shaderPath = arguments_.kernels.shaderPath;
    options.shaderLibrary = toolchain->installation.shaders;
    options.compiler = toolchain->compiler;
    options.cache = cache_ = toolchain->cache;
    options.target = target_ = toolchain->target;
    options.embreeIsa = arguments_.kernels.isa;
    options.laneCounters = arguments_.countLanes;
    options.textureMemory_MB = arguments_.textureMemory_MB;
    options.threads = threadCount();
    auto prepared = render::prepare(*description_, registry_, options, warnings);
    console_.report(warnings);
    if (!prepared) return accept(prepared.errors());
    scene_ = std::move(*prepared);
    times_.prepare = secondsSince(start);
    return true;
  }

  int threadCount() const {
    return arguments_.threads > 0 ? arguments_.threads
                                  : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  }

  void renderFilm() {
    film_ = std::make_unique<render::Film>(cropOf(description_->film));
    ProgressDisplay display(console_);
    render::RenderOptions options;
    options.threads = threadCount();
    options.endSample = static_cast<std::uint32_t>(description_->sampler.sampleCount);
    options.stop = &watch_.stopFlag();
    if (!arguments_.quiet) options.progress = [&](const render::Progress& progress) { display.show(progress); };
    watch_.startRendering();
    report_ = render::render(*scene_, *registry_.integrator(description_->integrator.type), *film_, options);
    display.finish();
    // A signal that came when all was done interrupted nothing.
    const auto samples = static_cast<std::uint64_t>(options.endSample) * film_->area().pixelCount();
    if (film_->sampleCount() + film_->droppedCount() == samples) report_.interrupted = false;
  }

  bool write() {
    const SampleCounts counts = countSamples(*film_);
    if (counts.total == 0 && report_.interrupted) {
      console_.note("aerosol: not one sample was finished, no image is written\n");
      return true;
    }
    image::ImageBuffer picture = makePicture(*film_, description_->film);
    picture.metadata = describeRender({arguments_, *description_, *scene_, report_, target_}, counts);
    const bool pointsAreSaved = accept(scene_->services->finish());
    if (!accept(writeOutputs(outputs_, picture, description_->film)) || !pointsAreSaved) return false;
    if (!arguments_.quiet) {
      for (const std::string& name : outputs_) {
        console_.note(fmt::format("wrote {}: {} x {} pixels, {} samples a pixel, {}\n", name, picture.width,
                                  picture.height, formatMean(counts.mean), formatDuration(report_.seconds)));
      }
    }
    return true;
  }

  void tell() {
    const ShaderReport report = reportMessages(scene_->messages->sorted(), scene_->messages->dropped());
    console_.print(report.printed);
    std::fflush(console_.out);
    console_.report(appendToFiles(report.files));
    console_.report(report.messages);
    Diagnostics found = reportInvalidCoefficients(*scene_);
    found.append(reportInvalidClosures(*scene_));
    found.append(reportTrackers(*scene_, report_.statistics.trackers));
    found.append(reportDroppedSamples(*film_));
    description_->sources->annotate(found);
    console_.report(found);
    if (arguments_.statistics || arguments_.countLanes) {
      console_.note(formatStatistics(*scene_, report_, *film_, times_, threadCount(), cache_.get()));
    }
  }

  const RenderArguments& arguments_;
  const Console& console_;
  InterruptWatch watch_;
  render::Registry registry_;
  std::vector<std::string> outputs_;
  std::optional<scene::SceneDescription> description_;
  std::shared_ptr<jit::ObjectCache> cache_;
  jit::Target target_;
  std::unique_ptr<const render::PreparedScene> scene_;
  std::unique_ptr<render::Film> film_;
  render::RenderReport report_;
  PreparationTimes times_;
};

}  // namespace

ExitCode renderCommand(const RenderArguments& arguments, const Console& console) {
  return Render(arguments, console).run();
}

}  // namespace aerosol::app

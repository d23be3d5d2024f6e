#include "core/app/render_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <thread>

#include "core/app/cost_report.h"
#include "core/app/deep_picture.h"
#include "core/app/doctor/examination.h"
#include "core/app/file_watch.h"
#include "core/app/film_file.h"
#include "core/app/frames.h"
#include "core/app/interrupt.h"
#include "core/app/output_files.h"
#include "core/app/picture.h"
#include "core/app/progress.h"
#include "core/app/quantity.h"
#include "core/app/render_rounds.h"
#include "core/app/scene_session.h"
#include "core/app/shader_report.h"
#include "core/app/statistics_report.h"
#include "core/app/step_accuracy.h"
#include "core/app/tev_view.h"
#include "core/render/film_archive.h"
#include "core/render/medium_facts.h"
#include "core/render/renderer.h"

namespace aerosol::app {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

bool isExr(const std::string& name) { return name.size() > 4 && name.ends_with(".exr"); }

/// One image, step by step. A step that fails has told why.
class Render {
 public:
  Render(const RenderArguments& arguments, const Console& console, InterruptWatch& watch)
      : Render(arguments, console, watch, watch.stopFlag()) {}
  /// `stop` ends the render before its time.
  Render(const RenderArguments& arguments, const Console& console, InterruptWatch& watch, const std::atomic<bool>& stop)
      : arguments_(arguments), console_(console), watch_(watch), stop_(stop), session_(arguments, console) {}

  ExitCode run() {
    if (const ExitCode code = makeReady(); code != ExitCode::success || isDone_) return code;
    renderFilm();
    return finish();
  }

  /// Reads all that the image is made of.
  ExitCode makeReady() {
    outputs_ = outputNames(arguments_.outputs, arguments_.scene);
    if (!accept(checkOutputNames(outputs_)) || !accept(checkCombination())) return ExitCode::usage;
    if (!accept(checkOutputPlaces(filesToWrite())) || !prepare() || !chooseSamples()) return ExitCode::badInput;
    isDone_ = arguments_.resume && isThere();
    if (isDone_) return ExitCode::success;
    if (!connectViewer()) return ExitCode::badInput;
    const bool isReady = accept(tryOutputs(outputs_, session_.description().film, arguments_.display));
    if (isReady && arguments_.adaptive) makeMap();
    return isReady && resume() ? ExitCode::success : ExitCode::badInput;
  }

  bool isInterrupted() const { return report_.interrupted; }
  std::set<std::string> files() const { return session_.files(); }

  /// Writes the images and says what there is to say.
  ExitCode finish() {
    const bool isWritten = write();
    tell();
    if (!writeStatistics() || !isWritten) return ExitCode::badInput;
    return report_.interrupted ? ExitCode::interrupted : ExitCode::success;
  }

  void renderFilm() {
    const Goal goal{arguments_.targetError, timeLeft(), mostSamples()};
    ProgressDisplay display(console_, goal.error);
    render::RenderOptions options;
    options.threads = session_.threadCount();
    options.firstSample = static_cast<std::uint32_t>(range_.first);
    options.endSample = static_cast<std::uint32_t>(range_.end);
    options.map = map_ ? &*map_ : nullptr;
    options.profile = arguments_.explainCost || !arguments_.statisticsFile.empty();
    const auto start = Clock::now();
    if (arguments_.checkpointSeconds > 0) {
      options.checkpointSeconds = arguments_.checkpointSeconds;
      options.checkpoint = [&](std::string sums) { writeCheckpoint(std::move(sums), secondsSince(start)); };
    }
    options.stop = &stop_;
    if (!arguments_.quiet) options.progress = [&](const render::Progress& progress) { display.show(progress); };
    if (tev_) options.partDone = [this](const render::PixelRect& part) { tev_->show(*film_, part); };
    watch_.startRendering();
    const render::Integrator& integrator = session_.integrator();
    if (goal) {
      const GoalReport reached = renderTowards(goal, session_.scene(), integrator, *film_, std::move(options));
      report_ = reached.render;
      range_.end = static_cast<int>(reached.samples);
      session_.description().sampler.sampleCount = job_.sampleCount = range_.end;
      display.finish();
      tellGoal(goal, reached);
    } else {
      report_ = render::render(session_.scene(), integrator, *film_, options);
      display.finish();
    }
    // A signal that came when all was done interrupted nothing.
    if (film_->sampleCount() + film_->droppedCount() == samplesAsked()) report_.interrupted = false;
    keepInterrupted();
  }

 private:
  bool accept(const Diagnostics& diagnostics) {
    console_.report(diagnostics);
    return !diagnostics.hasErrors();
  }

  bool prepare() {
    if (!session_.load() || !session_.prepare()) return false;
    if (render::mostStepsAcross(session_.scene()) > render::endlessSteps) {
      Diagnostics endless = examineSampling(session_.description(), session_.scene());
      session_.description().sources->annotate(endless);
      console_.report(endless);
    }
    const bool mayRefine = arguments_.targetError > 0 && !arguments_.stepScale;
    if (mayRefine && marches(session_.scene()) && !refineSteps()) return false;
    job_ = describeJob(arguments_, session_.description(), session_.scene());
    return accept(applyCrop(arguments_.crop, session_.description().film));
  }

  /// Where marching is worse than the error that is asked for, more samples would not help.
  bool refineSteps() {
    watch_.startRendering();
    const StepAccuracy found = findStepScale(session_, arguments_.targetError, stop_);
    float& stepScale = session_.description().integrator.stepScale;
    if (found.stepScale == stepScale || stop_) return true;
    if (!arguments_.quiet) {
      console_.note(fmt::format("steps of marching x {:.4g}: their bias is {} of the image, and would be {}\n",
                                found.stepScale / stepScale, formatError(found.after), formatError(found.before)));
    }
    stepScale = found.stepScale;
    return session_.prepareAgain();
  }

  /// Which tiles take how many samples, from a render of the same pixels with numbers of its own. It depends on the
  /// scene and the number of samples alone, so that a render which goes on takes the same.
  void makeMap() {
    render::Film pilot(cropOf(session_.description().film));
    render::RenderOptions options;
    options.threads = session_.threadCount();
    options.endSample = render::pilotSamples(arguments_.targetError > 0 || arguments_.timeLimit > 0
                                                 ? std::numeric_limits<std::uint32_t>::max()
                                                 : static_cast<std::uint32_t>(range_.end));
    options.seed = session_.scene().seed ^ 0x9e3779b97f4a7c15u;
    options.stop = &stop_;
    watch_.startRendering();
    render::render(session_.scene(), session_.integrator(), pilot, options);
    map_.emplace(render::mapFromPilot(pilot));
  }

  std::uint64_t samplesAsked() const {
    const auto first = static_cast<std::uint32_t>(range_.first), end = static_cast<std::uint32_t>(range_.end);
    return map_ ? map_->total(end) - map_->total(first) : std::uint64_t{end - first} * film_->area().pixelCount();
  }

  std::vector<std::string> filesToWrite() const {
    std::vector<std::string> files = outputs_;
    if (!arguments_.deep.file.empty()) files.push_back(arguments_.deep.file);
    return files;
  }

  bool keepsSums() const { return arguments_.keepSums || arguments_.samples; }

  /// Options that exclude each other, and what needs an EXR file.
  Diagnostics checkCombination() const {
    Diagnostics errors;
    const bool hasGoal = arguments_.targetError > 0 || arguments_.timeLimit > 0;
    if (hasGoal && arguments_.samples) {
      errors.error({}, "--samples says how many samples there are; --target-error and --time find out",
                   {"leave one of them out"});
    }
    if (arguments_.adaptive && arguments_.samples) {
      errors.error({}, "--samples takes the same samples of each pixel; --adaptive does not",
                   {"leave one of them out"});
    }
    if (!arguments_.aovs.empty() && std::none_of(outputs_.begin(), outputs_.end(), isExr)) {
      errors.error({outputs_.front(), 0, 0}, "--aov needs an EXR file to write");
    }
    for (const auto& [effect, isAsked, option] : {std::tuple{"layers", !arguments_.aovs.empty(), "--aov"},
                                                  std::tuple{"deep-output", !arguments_.deep.file.empty(), "--deep"}}) {
      const auto& without = arguments_.without;
      if (isAsked && std::ranges::find(without, effect) != without.end()) {
        errors.error({}, fmt::format("--without {} leaves out what {} asks for", effect, option),
                     {"leave one of them out"});
      }
    }
    if (!arguments_.deep.file.empty()) {
      if (auto mistake = image::checkDeepFileName(arguments_.deep.file)) errors.add(std::move(*mistake));
      if (std::find(outputs_.begin(), outputs_.end(), arguments_.deep.file) != outputs_.end())
        errors.error({arguments_.deep.file, 0, 0}, "the deep image needs a file of its own");
    }
    if (keepsSums() && std::none_of(outputs_.begin(), outputs_.end(), isExr)) {
      errors.error({outputs_.front(), 0, 0},
                   fmt::format("{} needs an EXR file to write", arguments_.samples ? "--samples" : "--keep-sums"));
    }
    return errors;
  }

  /// AOVs that a scene asks for and no file shows.
  Diagnostics reportHiddenAovs() const {
    Diagnostics warnings;
    const auto& aovs = session_.description().integrator.aovs;
    if (!aovs.empty() && std::none_of(outputs_.begin(), outputs_.end(), isExr))
      warnings.warning(aovs.front().location, "no EXR file is written: the AOVs of the scene are lost",
                       {"-o NAME.exr"});
    return warnings;
  }

  bool connectViewer() {
    if (arguments_.tev.empty()) return true;
    const scene::Film& film = session_.description().film;
    auto view = TevView::connect(arguments_.tev, std::filesystem::path(outputs_.front()).filename().string(),
                                 film.width, film.height, hasAlpha(film.pixelFormat));
    if (!view) return accept(view.errors());
    tev_ = std::move(*view);
    return true;
  }

  bool chooseSamples() {
    const int count = session_.description().sampler.sampleCount;
    range_ = arguments_.samples.value_or(SampleRange{0, count});
    if (range_.end <= count) return true;
    Diagnostics errors;
    errors.error(
        {}, fmt::format("--samples {}:{} reaches beyond the {} samples of a pixel", range_.first, range_.end, count),
        {fmt::format("--spp {} gives the whole image more, the same for all of its parts", range_.end)});
    return accept(errors);
  }

  /// Whether an earlier run has made all outputs.
  bool isThere() const {
    const render::PixelRect area = cropOf(session_.description().film);
    for (const std::string& name : outputs_) {
      if (!isDone(name, job_, range_, area)) return false;
    }
    std::error_code missing;
    if (!arguments_.deep.file.empty() && !std::filesystem::exists(arguments_.deep.file, missing)) return false;
    if (!arguments_.quiet) console_.note(fmt::format("{} is done already\n", fmt::join(outputs_, ", ")));
    return true;
  }

  /// The film as the last checkpoint left it, or an empty one.
  bool resume() {
    const render::PixelRect area = cropOf(session_.description().film);
    const auto& aovs = session_.scene().aovs;
    film_ = std::make_unique<render::Film>(area, aovs ? aovs->layout : render::AovLayout{});
    std::error_code ignored;
    if (!arguments_.resume) return true;
    const std::string name = checkpointName(outputs_.front());
    if (!std::filesystem::exists(name, ignored)) {
      if (!arguments_.quiet)
        console_.note(fmt::format("{} is not there: the render starts from the beginning\n", name));
      return true;
    }
    auto file = readFilmFile(name);
    if (!file) return accept(file.errors());
    if (const std::string why = whyNotResumable(*file); !why.empty()) {
      console_.report(Diagnostic{Severity::error,
                                 {name, 0, 0},
                                 "this checkpoint cannot be carried on: " + why,
                                 {},
                                 {"remove the file, or leave --resume out, to start from the beginning"}});
      return false;
    }
    film_ = std::move(file->film);
    secondsBefore_ = file->seconds;
    hasCheckpoint_ = true;
    if (!arguments_.quiet) {
      console_.note(
          fmt::format("going on from {}, with {} samples a pixel\n", name, formatMean(countSamples(*film_).mean)));
    }
    return true;
  }

  std::string whyNotResumable(const FilmFile& file) const {
    Job asked = job_;
    asked.sampleCount = file.job.sampleCount;  // More or fewer samples are samples of the same image.
    if (std::string difference = differenceOf(file.job, asked); !difference.empty()) return difference;
    if (file.job.embreeIsa != job_.embreeIsa) {
      return fmt::format("it was rendered with the instruction set {}, not {}", file.job.embreeIsa, job_.embreeIsa);
    }
    if (file.job.code != job_.code) return fmt::format("it is of version {} of the program", file.job.code);
    if (file.film->area() != film_->area()) return "it shows other pixels";
    if (file.film->layout() != film_->layout()) return "it has other AOVs";
    if (!samplesLieWithin(*file.film, range_)) return "it has samples that are not asked for now";
    return {};
  }

  bool samplesLieWithin(const render::Film& film, const SampleRange& range) const {
    const auto first = static_cast<std::uint64_t>(range.first);
    for (int y = film.area().y0; y < film.area().y1; ++y) {
      for (int x = film.area().x0; x < film.area().x1; ++x) {
        const auto ranges = film.pixel(x, y).ranges();
        const auto asked = static_cast<std::uint32_t>(range.end);
        const std::uint64_t end = map_ ? map_->countAt(x, y, asked) : asked;
        if (!ranges.empty() && (ranges.front().first < first || ranges.back().end > end)) return false;
      }
    }
    return true;
  }

  /// Of the time limit, which preparation is part of; at least what one sample may take.
  double timeLeft() const {
    if (!(arguments_.timeLimit > 0)) return 0;
    return std::max(1e-3, arguments_.timeLimit - session_.times().load - session_.times().prepare);
  }

  std::uint32_t mostSamples() const {
    constexpr int unlimited = 1 << 20;
    return static_cast<std::uint32_t>(arguments_.samplesPerPixel.value_or(unlimited));
  }

  void tellGoal(const Goal& goal, const GoalReport& reached) const {
    if (arguments_.quiet || report_.interrupted) return;
    const bool isReached = !(goal.error > 0) || reached.error <= goal.error;
    const std::string error = reached.error > 0 ? ", error " + formatError(reached.error) : "";
    console_.note(fmt::format("{} a pixel{}{}\n", formatCount(reached.samples, "sample"), error,
                              isReached ? "" : fmt::format(": {} is not reached", formatError(goal.error))));
  }

  void keepInterrupted() {
    const bool isLong = report_.seconds >= arguments_.checkpointSeconds;
    if (report_.interrupted && arguments_.checkpointSeconds > 0 && (hasCheckpoint_ || isLong)) {
      writeCheckpoint(render::encodeFilm(*film_), report_.seconds);
      if (hasCheckpoint_ && !arguments_.quiet) console_.note("add --resume to the same command to go on\n");
    }
  }

  /// Its picture shows nothing: drawing it would take the time of the workers. Without compression it is soon written.
  void writeCheckpoint(std::string sums, double seconds) {
    image::ImageBuffer picture;
    picture.width = picture.height = 1;
    picture.fullWidth = session_.description().film.width;
    picture.fullHeight = session_.description().film.height;
    picture.channels = {"R", "G", "B"};
    if (hasAlpha(session_.description().film.pixelFormat)) picture.channels.push_back("A");
    picture.pixels.assign(picture.channels.size(), 0);
    picture.metadata = jobMetadata(job_);
    picture.metadata.push_back({"aerosol:renderSeconds", secondsBefore_ + seconds});
    picture.attachment = std::move(sums);
    image::WriteOptions options;
    options.compression = "none";
    const auto written = image::writeImage(checkpointName(outputs_.front()), picture, options);
    if (written) {
      hasCheckpoint_ = true;
    } else if (!warnedOfCheckpoint_) {
      warnedOfCheckpoint_ = true;
      for (Diagnostic each : written.errors().entries()) {
        each.severity = Severity::warning;
        console_.report(each);
      }
    }
  }

  void removeCheckpoint() {
    std::error_code ignored;
    if (hasCheckpoint_) std::filesystem::remove(checkpointName(outputs_.front()), ignored);
  }

  bool write() {
    const SampleCounts counts = countSamples(*film_);
    if (counts.total == 0 && report_.interrupted) {
      console_.note("aerosol: not one sample was finished, no image is written\n");
      return true;
    }
    image::ImageBuffer picture = makePicture(*film_, session_.description().film);
    picture.metadata = describeRender(
        {arguments_, session_.description(), session_.scene(), report_, session_.target(), range_, secondsBefore_},
        counts);
    const auto ofJob = jobMetadata(job_);
    picture.metadata.insert(picture.metadata.end(), ofJob.begin(), ofJob.end());
    if (map_) picture.metadata.push_back({"aerosol:adaptive", std::int32_t{1}});
    picture.layers = makeLayers(*film_);
    if (keepsSums()) picture.attachment = render::encodeFilm(*film_);
    const bool pointsAreSaved = accept(session_.scene().services->finish());
    if (!accept(writeOutputs(outputs_, picture, session_.description().film, arguments_.display)) || !pointsAreSaved)
      return false;
    if (!writeDeep(picture.metadata)) return false;
    if (!report_.interrupted) removeCheckpoint();
    if (!arguments_.quiet) {
      for (const std::string& name : outputs_) {
        console_.note(fmt::format("wrote {}: {} x {} pixels, {} samples a pixel, {}\n", name, picture.width,
                                  picture.height, formatMean(counts.mean), formatDuration(report_.seconds)));
      }
    }
    return true;
  }

  bool writeDeep(const std::vector<image::Metadata>& metadata) {
    if (arguments_.deep.file.empty()) return true;
    std::string note;
    if (!accept(writeDeepPicture(arguments_.deep, *film_, session_.description().film, metadata, note))) return false;
    if (!arguments_.quiet) console_.note(note);
    return true;
  }

  bool writeStatistics() {
    if (arguments_.statisticsFile.empty()) return true;
    return accept(writeTextFile(arguments_.statisticsFile,
                                statisticsJson({session_.scene(), report_, *film_, session_.times(),
                                                session_.threadCount(), arguments_.scene.filename().string()})));
  }

  void tell() {
    const ShaderReport report =
        reportMessages(session_.scene().messages->sorted(), session_.scene().messages->dropped());
    console_.print(report.printed);
    std::fflush(console_.out);
    console_.report(appendToFiles(report.files));
    console_.report(report.messages);
    Diagnostics found = reportInvalidCoefficients(session_.scene());
    found.append(reportAmplifyingMedia(session_.scene()));
    found.append(reportInvalidClosures(session_.scene()));
    found.append(reportTrackers(session_.scene(), report_.statistics.trackers));
    found.append(reportLights(report_.statistics));
    found.append(reportClamping(session_.scene(), report_.statistics));
    found.append(reportDroppedSamples(*film_));
    found.append(reportReplacedAovs(*film_));
    found.append(reportHiddenAovs());
    if (tev_ && !tev_->finish()) found.warning({}, "the connection to tev was lost: it shows an earlier state");
    session_.description().sources->annotate(found);
    console_.report(found);
    if (arguments_.explainCost) console_.note(explainCost(session_.scene(), report_, session_.threadCount()));
    if (arguments_.statistics || arguments_.countLanes) {
      console_.note(formatStatistics(session_.scene(), report_, *film_, session_.times(), session_.threadCount(),
                                     session_.cache()));
    }
  }

  const RenderArguments& arguments_;
  const Console& console_;
  InterruptWatch& watch_;
  const std::atomic<bool>& stop_;
  SceneSession session_;
  std::vector<std::string> outputs_;
  std::optional<render::SampleMap> map_;  ///< Of an adaptive render.
  std::unique_ptr<render::Film> film_;
  std::unique_ptr<TevView> tev_;  ///< Null without a viewer.
  render::RenderReport report_;
  Job job_;
  SampleRange range_;
  double secondsBefore_ = 0;    ///< Of the render that is carried on.
  bool isDone_ = false;         ///< By an earlier run.
  bool hasCheckpoint_ = false;  ///< The file is there and of this render.
  bool warnedOfCheckpoint_ = false;
};

/// One after the other; what ends one badly ends all.
ExitCode renderFrames(const RenderArguments& arguments, const Console& console, InterruptWatch& watch) {
  std::vector<std::string> files = arguments.outputs;
  if (!arguments.deep.file.empty()) files.push_back(arguments.deep.file);
  for (const std::string& name : files) {
    if (hasFramePlace(name)) continue;
    console.note(fmt::format("aerosol: error: '{}' has no place for the number of the frame, such as %04d\n", name));
    return ExitCode::usage;
  }
  for (const int frame : arguments.frames) {
    RenderArguments single = arguments;
    single.outputs.clear();
    const std::vector<std::string> names =
        arguments.outputs.empty() ? std::vector{arguments.scene.stem().string() + ".%04d.png"} : arguments.outputs;
    for (const std::string& name : names) single.outputs.push_back(nameOfFrame(name, frame));
    if (!arguments.deep.file.empty()) single.deep.file = nameOfFrame(arguments.deep.file, frame);
    single.defines.try_emplace("frame", std::to_string(frame));
    const ExitCode code = Render(single, console, watch).run();
    if (code != ExitCode::success) return code;
  }
  return ExitCode::success;
}

/// Renders, and starts over when a file changes. The new scene is made ready while the old one is still rendered, so
/// that one with errors disturbs nothing.
class WatchedRender {
 public:
  WatchedRender(const RenderArguments& arguments, const Console& console, InterruptWatch& signals)
      : arguments_(arguments), console_(console), signals_(signals) {}

  ExitCode run() {
    auto current = makeRender();
    ExitCode code = current->makeReady();
    if (code == ExitCode::usage) return code;
    bool isGood = code == ExitCode::success;
    signals_.startRendering();
    watch(*current);
    for (;;) {
      stop_ = false;
      next_.reset();
      std::jthread watcher([this] { await(); });
      if (isGood) {
        current->renderFilm();
        // What a change has cut off is not worth keeping.
        if (!current->isInterrupted() || signals_.stopFlag()) code = current->finish();
      }
      if (!stop_) console_.note("watching for changes; Ctrl-C ends\n");
      watcher.join();
      if (!next_) return code;
      current = std::move(next_);
      isGood = true;
      watch(*current);
    }
  }

 private:
  std::unique_ptr<Render> makeRender() { return std::make_unique<Render>(arguments_, console_, signals_, stop_); }

  void watch(const Render& render) {
    known_ = render.files();
    files_.watch(known_);
  }

  /// Returns when another scene is ready, or a signal has come; `stop_` is set then.
  void await() {
    using namespace std::chrono_literals;
    while (!signals_.stopFlag()) {
      std::this_thread::sleep_for(100ms);
      if (!files_.hasChanged()) continue;
      std::this_thread::sleep_for(50ms);  // Editors write in several steps.
      files_.hasChanged();
      auto render = makeRender();
      if (render->makeReady() == ExitCode::success) {
        next_ = std::move(render);
        break;
      }
      // Files that are new in it may hold the mistake.
      known_.merge(render->files());
      files_.watch(known_);
    }
    stop_ = true;
  }

  const RenderArguments& arguments_;
  const Console& console_;
  InterruptWatch& signals_;
  std::atomic<bool> stop_{false};
  FileWatch files_;
  std::set<std::string> known_;
  std::unique_ptr<Render> next_;
};

}  // namespace

ExitCode renderCommand(const RenderArguments& arguments, const Console& console) {
  InterruptWatch watch(console);
  if (arguments.watch) return WatchedRender(arguments, console, watch).run();
  return arguments.frames.empty() ? Render(arguments, console, watch).run() : renderFrames(arguments, console, watch);
}

}  // namespace aerosol::app

#include "core/app/study/study_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/app/film_file.h"
#include "core/app/interrupt.h"
#include "core/app/output_files.h"
#include "core/app/picture.h"
#include "core/app/pilot.h"
#include "core/app/quantity.h"
#include "core/app/scene_session.h"
#include "core/app/study/axes.h"
#include "core/app/study/measure.h"
#include "core/app/study/report.h"
#include "core/app/version_command.h"
#include "core/base/archive.h"
#include "core/base/hash.h"
#include "core/render/film_error.h"

namespace aerosol::app {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using scene::DistanceSampling;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Of the budget, for the reference.
constexpr double referenceShare = 0.35;
/// The reference's squared error has to be smaller than this part of what is measured against it.
constexpr double largestReferencePart = 0.5;
constexpr float referenceStepScale = 1.0f / 8;

/// Several independent renders of one prepared scene, carried on together.
class Repetitions {
 public:
  Repetitions(const SceneSession& session, const render::PixelRect& area, int count, std::uint64_t firstSeed,
              const std::atomic<bool>& stop)
      : session_(session), stop_(stop), firstSeed_(firstSeed) {
    for (int i = 0; i < count; ++i) films_.push_back(std::make_unique<render::Film>(area));
  }

  /// Each to `samples` a pixel. False when interrupted.
  bool extendTo(std::uint32_t samples) {
    const Clock::time_point start = Clock::now();
    const std::clock_t processorStart = std::clock();
    for (std::size_t i = 0; i < films_.size(); ++i) {
      render::RenderOptions options;
      options.threads = session_.threadCount();
      options.firstSample = samples_;
      options.endSample = samples;
      options.seed = hashString(fmt::format("study {}", firstSeed_ + i));
      options.stop = &stop_;
      if (render::render(session_.scene(), session_.integrator(), *films_[i], options).interrupted) return false;
    }
    samples_ = samples;
    seconds_ += secondsSince(start);
    processorSeconds_ += static_cast<double>(std::clock() - processorStart) / CLOCKS_PER_SEC;
    return true;
  }

  std::uint32_t samples() const { return samples_; }
  double seconds() const { return seconds_; }  ///< All of them together, waiting for other programs included.
  /// All of them together on a machine that has nothing else to do.
  double idleSeconds() const { return processorSeconds_ / session_.threadCount(); }
  /// Of what the threads could have had, the machine gave so much.
  StudyMachineTime machineTime() const { return {processorSeconds_, seconds_ * session_.threadCount()}; }
  std::vector<StudyImage> images() const {
    std::vector<StudyImage> images;
    for (const auto& film : films_) {
      const std::vector<float> rgba = film->rgba();
      StudyImage& image = images.emplace_back();
      image.reserve(rgba.size() / 4 * 3);
      for (std::size_t i = 0; i < rgba.size(); i += 4) {
        image.insert(image.end(), rgba.begin() + static_cast<std::ptrdiff_t>(i),
                     rgba.begin() + static_cast<std::ptrdiff_t>(i + 3));
      }
    }
    return images;
  }

 private:
  const SceneSession& session_;
  const std::atomic<bool>& stop_;
  std::uint64_t firstSeed_;
  std::vector<std::unique_ptr<render::Film>> films_;
  std::uint32_t samples_ = 0;
  double seconds_ = 0, processorSeconds_ = 0;
};

class Study {
 public:
  Study(const StudyArguments& arguments, const Console& console)
      : arguments_(arguments), console_(console), watch_(console) {}

  ExitCode run() {
    if (!makeFolder()) return ExitCode::badInput;
    SceneSession session(arguments_.render, console_);
    if (!load(session)) return ExitCode::badInput;
    auto settings = studySettings(arguments_, session.scene(), allowsNullScattering());
    if (!settings) {
      console_.report(settings.errors());
      return ExitCode::usage;
    }
    describe(session, *settings);
    restore();
    watch_.startRendering();
    if (results_.reference.mean.empty() && !makeReference(session)) return finish(ExitCode::badInput);
    for (const StudySetting& setting : *settings) {
      if (watch_.stopFlag()) break;
      if (!measure(setting, settings->size())) return finish(ExitCode::badInput);
    }
    return finish(ExitCode::success);
  }

 private:
  void note(const std::string& text) const {
    if (!arguments_.render.quiet) console_.note(text);
  }

  bool makeFolder() {
    std::error_code error;
    fs::create_directories(arguments_.folder, error);
    if (!error) return true;
    console_.report(
        Diagnostic{Severity::error, {arguments_.folder, 0, 0}, "cannot make this folder: " + error.message(), {}, {}});
    return false;
  }

  /// Reads and prepares a variant of the scene at the study's size.
  bool load(SceneSession& session) const {
    if (!session.load()) return false;
    shrinkFilm(session.description().film, arguments_.size);
    return session.prepare();
  }

  /// Whether every medium has a bound that null scattering can work with.
  bool allowsNullScattering() const {
    RenderArguments arguments = arguments_.render;
    arguments.distance = DistanceSampling::nullScattering;
    SceneSession session(arguments, silent_.get());
    return load(session);
  }

  void describe(const SceneSession& session, const std::vector<StudySetting>& settings) {
    const render::PixelRect area = cropOf(session.description().film);
    results_.scene = arguments_.render.scene.filename().string();
    results_.program = fmt::format("aerosol {}", programVersion());
    results_.machine =
        fmt::format("{} of {} processors, {} x {}", session.threadCount(), std::thread::hardware_concurrency(),
                    jit::name(session.target().isa), session.target().width);
    results_.repetitions = arguments_.repetitions;
    results_.budget = arguments_.budget;
    results_.reference.width = area.width();
    results_.reference.height = area.height();
    const Job job = describeJob(arguments_.render, session.description(), session.scene());
    StrongHash key;
    key.add(job.identity)
        .add(job.code)
        .add(results_.machine)
        .add(fmt::format("{} {} {} {}", area.width(), area.height(), arguments_.repetitions, arguments_.budget));
    for (const StudySetting& setting : settings) key.add(fmt::format("{}", fmt::join(setting.words, " ")));
    results_.key = key.hex();
  }

  std::string stateName() const { return (fs::path(arguments_.folder) / "study.state").string(); }

  /// Takes over what an earlier run of the same study has finished.
  void restore() {
    std::ifstream stream(stateName(), std::ios::binary);
    if (!stream) return;
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    const std::string text = bytes.str();
    StudyResults found;
    ArchiveReader archive(text);
    archive(found);
    if (!archive.succeeded() || found.key != results_.key) {
      note(fmt::format("{} holds another study, which is replaced\n", arguments_.folder));
      return;
    }
    std::erase_if(found.cases, [](const StudyCase& each) { return !each.isComplete; });
    note(fmt::format("going on with {} of an earlier run\n", formatCount(found.cases.size(), "finished case")));
    results_ = std::move(found);
  }

  bool save() {
    ArchiveWriter archive;
    archive(results_);
    const Diagnostics errors = writeTextFile(stateName(), archive.take());
    console_.report(errors);
    return !errors.hasErrors();
  }

  bool makeReference(const SceneSession& asItIs) {
    RenderArguments arguments = arguments_.render;
    StudyReference& reference = results_.reference;
    reference.method = "the scene as it is";
    if (hasVaryingMedium(asItIs.scene())) {
      reference.isUnbiased = allowsNullScattering();
      arguments.distance = reference.isUnbiased ? DistanceSampling::nullScattering : DistanceSampling::marching;
      if (!reference.isUnbiased) arguments.stepScale = referenceStepScale * arguments.stepScale.value_or(1);
      reference.method = reference.isUnbiased ? "null scattering" : "marching, steps x 1/8";
    }
    SceneSession session(arguments, silent_.get());
    if (!load(session)) return false;
    Repetitions renders(session, cropOf(session.description().film), arguments_.repetitions, 1000, watch_.stopFlag());
    const double allowed = referenceShare * arguments_.budget;
    for (std::uint32_t samples = 4;; samples *= 2) {
      if (!renders.extendTo(samples)) return false;
      summarise(renders.images(), reference);
      note(fmt::format("reference: {} samples a pixel, error {}, {}\n",
                       samples * static_cast<std::uint32_t>(arguments_.repetitions), formatError(reference.error),
                       formatDuration(renders.seconds())));
      // The next round takes as long as all before.
      if (2 * renders.seconds() > allowed || samples >= 1u << 16) break;
    }
    reference.samples = renders.samples() * static_cast<std::uint32_t>(arguments_.repetitions);
    reference.seconds = renders.idleSeconds();
    results_.machineTime += renders.machineTime();
    return save();
  }

  StudyCase* find(const StudySetting& setting) {
    const auto at = std::find_if(results_.cases.begin(), results_.cases.end(),
                                 [&](const StudyCase& each) { return each.arguments == setting.words; });
    return at == results_.cases.end() ? nullptr : &*at;
  }

  bool measure(const StudySetting& setting, std::size_t count) {
    if (find(setting)) return true;
    SceneSession session(setting.arguments, silent_.get());
    if (!load(session)) {
      SceneSession again(setting.arguments, console_);
      return load(again);  // Tells what is wrong.
    }
    StudyCase study{.name = setting.name,
                    .arguments = setting.words,
                    .prepareSeconds = session.times().prepare,
                    .rounds = {},
                    .picture = {}};
    Repetitions renders(session, cropOf(session.description().film), arguments_.repetitions, 1, watch_.stopFlag());
    const double allowed = (1 - referenceShare) * arguments_.budget / static_cast<double>(count);
    for (std::uint32_t samples = 1;; samples *= 2) {
      if (!renders.extendTo(samples)) break;
      const auto images = renders.images();
      StudyRound round = measureRound(images, results_.reference, samples);
      round.seconds = renders.idleSeconds() / arguments_.repetitions;
      study.rounds.push_back(round);
      study.picture = images.front();
      const bool isReferenceWorse = results_.reference.error * results_.reference.error >
                                    largestReferencePart * std::max(round.squaredError.value, 0.0);
      study.isComplete = 2 * renders.seconds() > allowed || isReferenceWorse || samples >= 1u << 16;
      if (study.isComplete) break;
    }
    results_.machineTime += renders.machineTime();
    if (!study.rounds.empty()) {
      const StudyRound& last = study.rounds.back();
      note(fmt::format("{}: {} samples a pixel, error {}, {} a render\n", study.name, last.samples,
                       formatError(std::sqrt(std::max(0.0, last.squaredError.value))), formatDuration(last.seconds)));
    }
    results_.cases.push_back(std::move(study));
    if (!save()) return false;
    const Diagnostics errors = writeStudy(results_, arguments_.folder);
    console_.report(errors);
    return !errors.hasErrors();
  }

  ExitCode finish(ExitCode code) {
    if (watch_.stopFlag()) code = ExitCode::interrupted;
    if (results_.reference.mean.empty()) return code;
    const Diagnostics errors = writeStudy(results_, arguments_.folder);
    console_.report(errors);
    if (errors.hasErrors()) return ExitCode::badInput;
    for (const std::string& sentence : conclusions(results_)) console_.print(sentence + "\n");
    note(fmt::format("wrote {}\n", (fs::path(arguments_.folder) / "study.html").string()));
    return code;
  }

  const StudyArguments& arguments_;
  const Console& console_;
  InterruptWatch watch_;
  SilentConsole silent_;
  StudyResults results_;
};

}  // namespace

ExitCode studyCommand(const StudyArguments& arguments, const Console& console) {
  return Study(arguments, console).run();
}

}  // namespace aerosol::app

#include "core/app/submit/submit_command.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "core/app/frames.h"
#include "core/app/output_files.h"
#include "core/app/quantity.h"
#include "core/app/scene_session.h"
#include "core/app/submit/job_files.h"
#include "core/scene/field.h"

namespace aerosol::app {

namespace {

namespace fs = std::filesystem;

/// "shot" of "shot.%04d".
std::string withoutFrame(std::string name) {
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return name;
  name.resize(percent);
  while (!name.empty() && (name.back() == '.' || name.back() == '_' || name.back() == '-')) name.pop_back();
  return name.empty() ? "frames" : name;
}

class Submission {
 public:
  Submission(const SubmitArguments& arguments, const Console& console) : arguments_(arguments), console_(console) {}

  ExitCode run() {
    if (!checkOutputs()) return ExitCode::usage;
    SceneSession session(arguments_.render, console_);
    if (!session.load()) return ExitCode::badInput;
    plan(session.description().sampler.sampleCount);
    if (!write()) return ExitCode::badInput;
    console_.note(fmt::format("wrote {}: {}, {}\n", job_.folder, formatCount(job_.renders.size(), "render"),
                              formatCount(job_.merges.size(), "merge")));
    return !arguments_.slurm || submit() ? ExitCode::success : ExitCode::badInput;
  }

 private:
  bool fail(std::string message, std::vector<std::string> notes = {}) const {
    console_.report(Diagnostic{Severity::error, {}, std::move(message), {}, std::move(notes)});
    return false;
  }

  bool checkOutputs() const {
    if (arguments_.render.outputs.empty()) return fail("no output is given", {"-o FILE names the image to make"});
    std::vector<std::string> names = arguments_.render.outputs;
    if (!arguments_.render.deep.file.empty()) names.push_back(arguments_.render.deep.file);
    const Diagnostics errors = checkOutputNames(names);
    console_.report(errors);
    if (errors.hasErrors()) return false;
    for (const std::string& name : names) {
      if (!arguments_.render.frames.empty() && !hasFramePlace(name)) {
        return fail(fmt::format("'{}' has no place for the number of the frame, such as %04d", name));
      }
    }
    return true;
  }

  /// The words that all tasks share. One instruction set for all machines, so that bits do not depend on them.
  std::vector<std::string> commonWords(int spp) const {
    const RenderArguments& r = arguments_.render;
    std::vector<std::string> words{"--quiet",           "--resume", "--spp",
                                   std::to_string(spp), "--isa",    r.kernels.isa.empty() ? "avx2" : r.kernels.isa};
    for (const auto& [name, value] : r.defines) words.insert(words.end(), {"-D", name + "=" + value});
    if (!r.sensor.empty()) words.insert(words.end(), {"--sensor", r.sensor});
    for (const std::string& change : r.overrides) words.insert(words.end(), {"--set", change});
    for (const std::string& effect : r.without) words.insert(words.end(), {"--without", effect});
    for (const fs::path& path : r.kernels.shaderPath)
      words.insert(words.end(), {"--shader-path", fs::absolute(path).string()});
    if (r.seed) words.insert(words.end(), {"--seed", std::to_string(*r.seed)});
    if (r.stepScale) words.insert(words.end(), {"--step-scale", fmt::format("{}", *r.stepScale)});
    if (r.threads > 0) words.insert(words.end(), {"--threads", std::to_string(r.threads)});
    const auto addWord = [&](const char* option, const auto& choice, const auto& known) {
      if (choice) words.insert(words.end(), {option, known[static_cast<std::size_t>(*choice)]});
    };
    addWord("--distance", r.distance, scene::Words<scene::DistanceSampling>::words);
    addWord("--transmittance", r.transmittance, scene::Words<scene::TransmittanceSampling>::words);
    if (r.noEquiangular) words.push_back("--no-equiangular");
    if (r.loopBudget != RenderArguments().loopBudget)
      words.insert(words.end(), {"--loop-budget", std::to_string(r.loopBudget)});
    for (const scene::AovRequest& aov : r.aovs) words.insert(words.end(), {"--aov", aov.name + "=" + aov.quantity});
    if (r.jointLights) words.push_back("--joint-lights");
    if (!r.plan.empty()) words.insert(words.end(), {"--plan", fs::absolute(r.plan).string()});
    return words;
  }

  void plan(int spp) {
    const RenderArguments& r = arguments_.render;
    // Of the image, so that several of one scene have folders of their own.
    job_.name = withoutFrame(fs::path(r.outputs.front()).stem().string());
    job_.program = fs::read_symlink("/proc/self/exe").string();
    const std::string place = r.outputs.front();
    job_.folder = arguments_.folder.empty()
                      ? fs::absolute(fs::path(place).parent_path() / (job_.name + ".job")).string()
                      : fs::absolute(arguments_.folder).string();
    const auto common = commonWords(spp);
    std::vector<std::optional<int>> frames(r.frames.begin(), r.frames.end());
    if (frames.empty()) frames.emplace_back();
    for (const auto& frame : frames) addFrame(frame, spp, common);
  }

  void addFrame(const std::optional<int>& frame, int spp, const std::vector<std::string>& common) {
    const auto ranges = splitSamples(spp, arguments_.tasks);
    std::vector<std::string> outputs, merge{"merge", "--quiet"};
    const auto place = [&](const std::string& name) {
      return name.empty() ? name : fs::absolute(frame ? nameOfFrame(name, *frame) : name).string();
    };
    for (const std::string& name : arguments_.render.outputs) outputs.insert(outputs.end(), {"-o", place(name)});
    const DeepArguments& deep = arguments_.render.deep;
    const auto addDeep = [&](std::vector<std::string>& words, const std::string& file, bool gathers) {
      if (deep.file.empty()) return;
      words.insert(words.end(), {"--deep", file, "--deep-error", fmt::format("{}", deep.error)});
      if (gathers) words.insert(words.end(), {"--deep-slices", std::to_string(deep.slices)});
    };
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      SubmitTask task{frame, {}, {"render", fs::absolute(arguments_.render.scene).string()}};
      task.words.insert(task.words.end(), common.begin(), common.end());
      if (frame) task.words.insert(task.words.end(), {"-D", fmt::format("frame={}", *frame)});
      if (ranges.size() > 1) {
        task.samples = ranges[i];
        const std::string part = fmt::format("{}/parts/{}{}-{}.exr", job_.folder,
                                             frame ? fmt::format("f{}-", *frame) : "", ranges[i].first, ranges[i].end);
        task.words.insert(task.words.end(),
                          {"--samples", fmt::format("{}:{}", ranges[i].first, ranges[i].end), "-o", part});
        addDeep(task.words, part.substr(0, part.size() - 4) + ".deep.exr", true);
        merge.push_back(part);
      } else {
        task.words.insert(task.words.end(), outputs.begin(), outputs.end());
        addDeep(task.words, place(deep.file), true);
      }
      job_.renders.push_back(std::move(task));
    }
    if (ranges.size() < 2) return;
    merge.insert(merge.end(), outputs.begin(), outputs.end());
    addDeep(merge, place(deep.file), false);
    job_.merges.push_back(std::move(merge));
  }

  bool write() const {
    std::error_code error;
    for (const char* sub : {"", "/parts", "/logs"}) fs::create_directories(job_.folder + sub, error);
    if (error) return fail(fmt::format("cannot make the folder {}: {}", job_.folder, error.message()));
    Diagnostics errors = writeTextFile(job_.folder + "/tasks.sh", tasksScript(job_));
    errors.append(writeTextFile(job_.folder + "/render.sbatch", slurmArrayScript(job_)));
    errors.append(writeTextFile(job_.folder + "/parallel.sh", parallelScript(job_)));
    errors.append(writeTextFile(job_.folder + "/opencue.py", openCueOutline(job_)));
    if (!job_.merges.empty()) {
      errors.append(writeTextFile(job_.folder + "/merges.sh", mergesScript(job_)));
      errors.append(writeTextFile(job_.folder + "/merge.sbatch", slurmMergeScript(job_)));
    }
    console_.report(errors);
    return !errors.hasErrors();
  }

  /// What the command prints; nothing when it fails.
  static std::optional<std::string> outputOf(const std::string& command) {
    std::FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) return {};
    std::string text;
    std::array<char, 256> part;
    while (std::fgets(part.data(), part.size(), pipe)) text += part.data();
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    if (pclose(pipe) != 0 || text.empty()) return {};
    return text;
  }

  /// The merge runs whatever became of the renders: it is what tells that one is missing.
  bool submit() const {
    const auto sbatch = [&](const std::string& options, const char* file) {
      return outputOf("sbatch --parsable " + options + shellQuote(job_.folder + "/" + file));
    };
    const auto render = sbatch("", "render.sbatch");
    if (!render) {
      return fail("sbatch did not take the job", {"what it said is above; the files are written: " + job_.folder});
    }
    const std::string id = render->substr(0, render->find(';'));
    console_.print(fmt::format("render job {}\n", id));
    if (job_.merges.empty()) return true;
    const auto merge = sbatch("--dependency=afterany:" + id + " ", "merge.sbatch");
    if (!merge) return fail("sbatch did not take the merge");
    console_.print(fmt::format("merge job {}\n", merge->substr(0, merge->find(';'))));
    return true;
  }

  const SubmitArguments& arguments_;
  const Console& console_;
  SubmitJob job_;
};

}  // namespace

ExitCode submitCommand(const SubmitArguments& arguments, const Console& console) {
  return Submission(arguments, console).run();
}

}  // namespace aerosol::app

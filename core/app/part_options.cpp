#include "core/app/command_line.h"
#include "core/app/frames.h"
#include "core/app/option_helpers.h"

// The commands about images in parts and about what accuracy costs.

namespace aerosol::app {

namespace {

constexpr const char* mergeExamples = R"(Examples:
  aerosol render cloud.xml --spp 256 --samples 0:100 -o a.exr      on one machine
  aerosol render cloud.xml --spp 256 --samples 100:256 -o b.exr    on another
  aerosol merge a.exr b.exr -o cloud.exr -o cloud.png

The result has the bits of a render in one piece. Samples that are missing or there twice are errors.)";

constexpr const char* studyExamples = R"(Examples:
  aerosol study cloud.xml -o study/                                methods, and marching with several steps
  aerosol study cloud.xml -o study/ --vary volume.step_scale=1,2,4,8,16
  aerosol study cloud.xml -o study/ --vary cumulus.octaves=3,5,7 --budget 10m

The folder gets study.html, one page that needs no other file, the same as study.json and study.csv, the charts and
pictures as PNG. Interrupted, a study is carried on by the same command.)";

/// PARAMETER=VALUE,VALUE,…
std::optional<StudyAxis> parseAxis(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) return {};
  StudyAxis axis{text.substr(0, equals), {}};
  for (std::size_t at = equals + 1; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    if (comma == at) return {};
    axis.values.push_back(text.substr(at, comma - at));
    at = comma + 1;
  }
  return axis;
}

}  // namespace

void addMerge(CLI::App& program, MergeArguments& merge) {
  CLI::App& app = *program.add_subcommand("merge", "Join renders of parts to the image of the whole");
  app.footer(mergeExamples);
  app.add_option("parts", merge.parts, "EXR files of aerosol render --samples or --keep-sums, in any order")
      ->required()
      ->option_text("FILE...");
  addList(app, "-o,--output", "FILE", merge.outputs, "Image to write, .exr, .png or .jpg; repeatable");
  const auto crop = [&merge](const std::string& option, const std::string& text) {
    merge.crop = parseCrop(text);
    if (!merge.crop) refuse(option, fmt::format("'{}' is not four integers x,y,w,h, w and h at least 1", text));
  };
  addParsed(app, "--crop", "X,Y,W,H", crop, "The pixels that have to be there [all of the scene's film]");
  app.add_flag("--allow-missing", merge.allowMissing,
               "Write what there is, with its sums, so that it can be merged\nonce more");
  app.add_flag("--mixed", merge.mixed,
               "Join parts of different instruction sets or versions too: the\n"
               "image is right, but not the same bit by bit");
  addDeepOptions(app, merge.deep, false);
  addDisplayOptions(app, merge.display);
  app.add_flag("--quiet,-q", merge.quiet, "Say nothing but warnings and errors");
}

void addStudy(CLI::App& program, StudyArguments& study) {
  CLI::App& app = *program.add_subcommand("study", "Measure what accuracy costs: error, bias and noise against time");
  app.footer(studyExamples);
  app.add_option("scene", study.render.scene, "The scene")->required()->option_text(" ");
  app.add_option("-o,--output", study.folder, "Folder to write into")->required()->option_text("FOLDER");
  const auto axis = [&study](const std::string& option, const std::string& text) {
    auto parsed = parseAxis(text);
    if (!parsed) refuse(option, fmt::format("'{}' is not PARAMETER=VALUE,VALUE,...", text));
    study.axes.push_back(std::move(*parsed));
  };
  app.add_option_function<std::vector<std::string>>(
         "--vary",
         [axis](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) axis("--vary", text);
         },
         "Vary this instead of the method: a parameter as for --set, or\n"
         "volume.step_scale, distance or transmittance; several give\nevery combination")
      ->allow_extra_args(false)
      ->option_text("PARAMETER=VALUE,...");
  const auto budget = [&study](const std::string& option, const std::string& text) {
    const auto seconds = parseSeconds(text);
    if (!seconds || !(*seconds > 0)) refuse(option, fmt::format("'{}' is not a time such as 90s, 5m or 2h", text));
    study.budget = *seconds;
  };
  addParsed(app, "--budget", "TIME", budget, "Time for rendering, the reference's included [100s]");
  addInteger(app, "--size", study.size, 8, "Pixels of the longer side: larger films are made smaller [96]");
  addInteger(app, "--repetitions", study.repetitions, 3,
             "Independent renders of each configuration, which tell bias\nfrom noise [8]");
  addSceneOptions(app, study.render);
  addMethodOptions(app, study.render);
  addInteger(app, "--threads", study.render.threads, 1, "Threads [one a processor]", mostThreads);
  addKernelOptions(app, study.render.kernels);
  app.add_flag("--quiet,-q", study.render.quiet, "No progress");
}

namespace {

void addScene(CLI::App& app, RenderArguments& render) {
  app.add_option("scene", render.scene, "The scene")->required()->option_text(" ");
  addSceneOptions(app, render);
  addMethodOptions(app, render);
  addInteger(app, "--threads", render.threads, 1, "Threads [one a processor]", mostThreads);
  addKernelOptions(app, render.kernels);
}

}  // namespace

void addPlan(CLI::App& program, PlanArguments& plan) {
  CLI::App& app = *program.add_subcommand("plan", "List the effects that a scene calls for, why, and what they cost");
  app.footer(R"(Examples:
  aerosol plan cloud.xml
  aerosol plan cloud.xml --without multiple-scattering    what it changes is rendered, and told
  aerosol plan cloud.xml --deep cloud.exr                 what a deep image would cost (none is written)

What the plan says is off is not done: it costs nothing. Shares are estimates, and may be parts of each other: those of media
are parts of 'heterogeneity', and scattering has the share of all segments of paths that follow it. aerosol help effects explains the rows, and what --without changes.)");
  addScene(app, plan.render);
  addAovOption(app, plan.render.aovs);
  addDeepOptions(app, plan.render.deep, true);
  addInteger(app, "--size", plan.size, 1, "Pixels of the longer side of the pilot that costs come from [160]");
}

void addDoctor(CLI::App& program, DoctorArguments& doctor) {
  CLI::App& app = *program.add_subcommand("doctor", "Look for what will go wrong in a scene, and say what helps");
  app.footer(
      "Looks for open meshes, violated bounds, shaders that give NaN, coincident surfaces, steps that will not finish "
      "and "
      "unused inputs.\nExit codes: 0 nothing found, 1 something found.");
  addScene(app, doctor.render);
  addInteger(app, "--size", doctor.size, 1, "Pixels of the longer side of the pilot [96]");
}

void addCheck(CLI::App& program, CheckArguments& check) {
  CLI::App& app = *program.add_subcommand("check", "Tell everything that is wrong with a scene at once");
  app.footer(
      "Reads and prepares the scene as a render does, and goes on after errors: unknown objects and parameters, "
      "shaders\n"
      "that do not compile, files that are missing or damaged. Renders nothing; aerosol doctor looks for what goes "
      "wrong\n"
      "while rendering.\nExit codes: 0 no errors (there may be warnings), 1 errors, 2 bad command line.");
  addScene(app, check.render);
}

void addSubmit(CLI::App& program, SubmitArguments& submit) {
  CLI::App& app =
      *program.add_subcommand("submit", "Render on a queue: cut into tasks, for Slurm, OpenCue or GNU parallel");
  app.footer(R"(Examples:
  aerosol submit cloud.xml -o cloud.exr --spp 1024 --tasks 16 --slurm     an array job, and a merge after it
  aerosol submit shot.xml -o shot.%04d.exr --frames 1-100 --tasks 1 --slurm
  aerosol submit cloud.xml -o cloud.exr && sh cloud.job/parallel.sh -j 4  without a queue

The folder gets tasks.sh and merges.sh, which run one task by its number, and what queues need to call them:
render.sbatch and merge.sbatch, parallel.sh, opencue.py. All machines have to see the folder and the scene. A task that is
lost or was run twice is found by the merge. Tasks that are started again go on where they were.)");
  addScene(app, submit.render);
  addList(app, "-o,--output", "FILE", submit.render.outputs, "Image to make, .exr, .png or .jpg; repeatable");
  addInteger(app, "--spp", submit.render.samplesPerPixel, 1, "Samples a pixel, instead of the scene's");
  const auto frames = [&submit](const std::string& option, const std::string& text) {
    auto list = parseFrames(text);
    if (!list) refuse(option, fmt::format("'{}' is not a list of frames such as 7, 1-100 or 1-100x5,200", text));
    submit.render.frames = std::move(*list);
  };
  addParsed(app, "--frames", "LIST", frames, "Frames, as for aerosol render");
  addInteger(app, "--tasks", submit.tasks, 1, "Parts into which the samples of each frame are cut [8]");
  app.add_option("--folder", submit.folder, "For the job's files [NAME.job beside the first output,\nNAME.exr]")
      ->option_text("FOLDER");
  app.add_flag("--slurm", submit.slurm, "Give the job to Slurm (sbatch)");
  addAovOption(app, submit.render.aovs);
  addDeepOptions(app, submit.render.deep, true);
}

}  // namespace aerosol::app

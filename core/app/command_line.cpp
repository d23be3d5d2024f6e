#include "core/app/command_line.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "core/app/bake_options.h"
#include "core/app/frames.h"
#include "core/app/option_helpers.h"
#include "core/app/tools/tool.h"
#include "core/base/diagnostic.h"
#include "core/scene/integrator_reader.h"
#include "core/scene/value.h"

namespace aerosol::app {

namespace {

constexpr const char* programExamples = R"(Examples:
  aerosol render scenes/first_light.xml -o cloud.exr -o cloud.png
  aerosol compile my_cloud.osl       check a shader while you write it
  aerosol help scene                 everything that a scene file can hold
  aerosol help medium                one element, object type or shader

Exit codes: 0 done, 1 bad input, 2 bad command line, 3 interrupted)";

constexpr const char* renderExamples = R"(Examples:
  aerosol render cloud.xml                              writes cloud.png
  aerosol render cloud.xml -o cloud.exr -o cloud.png    linear values, and a picture to look at
  aerosol render cloud.xml --spp 4 --crop 300,200,64,64  a quick look at one corner
  aerosol render cloud.xml --set cumulus.density=12     tries another density
  aerosol render cloud.xml -D sun=40                    gives $sun in the scene a value
  aerosol render cloud.xml --samples 0:64 -o a.exr      a part of the samples, for aerosol merge
  aerosol render cloud.xml --frames 1-100 -o cloud.%04d.exr

Ctrl-C ends the render and writes what there is, with its number of samples in the file's metadata; pressed once more,
it ends the program at once.)";

/// Wide enough for the longest option, so that all texts stand in one column.
constexpr std::size_t optionColumn = 31;

void addPartOptions(CLI::App& app, RenderArguments& render) {
  const auto samples = [&render](const std::string& option, const std::string& text) {
    render.samples = parseSampleRange(text);
    if (!render.samples) refuse(option, fmt::format("'{}' is not two numbers A:B with 0 <= A < B", text));
  };
  addParsed(app, "--samples", "A:B", samples,
            "Render the samples A <= i < B of each pixel alone; aerosol merge\njoins the files to the same image");
  const auto frames = [&render](const std::string& option, const std::string& text) {
    auto list = parseFrames(text);
    if (!list) refuse(option, fmt::format("'{}' is not a list of frames such as 7, 1-100 or 1-100x5,200", text));
    render.frames = std::move(*list);
  };
  addParsed(app, "--frames", "LIST", frames,
            "Render these frames, such as 1-100 or 1-100x5,200: $frame in the\n"
            "scene is the number, and so is %04d in the names of outputs");
  app.add_flag("--keep-sums", render.keepSums, "Keep in EXR files what aerosol merge needs (--samples does)");
  const auto checkpoint = [&render](const std::string& option, const std::string& text) {
    const auto seconds = parseSeconds(text);
    if (!seconds) refuse(option, fmt::format("'{}' is not a time such as 30, 90s, 5m or 2h", text));
    render.checkpointSeconds = *seconds;
  };
  addParsed(app, "--checkpoint", "TIME", checkpoint,
            "Save the state so often, beside the first output as\nNAME.checkpoint.exr [30s]; 0: never");
  const auto error = [&render](const std::string& option, const std::string& text) {
    const bool isPercent = text.ends_with('%');
    scene::TextError why;
    const auto number = scene::parseFloat(isPercent ? text.substr(0, text.size() - 1) : text, why);
    if (!number || !(*number > 0)) refuse(option, fmt::format("'{}' is not an error such as 1% or 0.01", text));
    render.targetError = static_cast<double>(*number) * (isPercent ? 0.01 : 1);
  };
  addParsed(app, "--target-error", "ERROR", error,
            "Render until the error of the image, as a part of its mean, is\n"
            "no larger, such as 1%; --spp is the most samples then");
  const auto time = [&render](const std::string& option, const std::string& text) {
    const auto seconds = parseSeconds(text);
    if (!seconds || !(*seconds > 0)) refuse(option, fmt::format("'{}' is not a time such as 90, 90s, 5m or 2h", text));
    render.timeLimit = *seconds;
  };
  addParsed(app, "--time", "TIME", time, "Render as many samples as this time allows, such as 60s or 5m");
  app.add_flag("--adaptive", render.adaptive,
               "Take more samples where the error is, and fewer elsewhere: a\n"
               "small render finds out first. --spp is their mean");
  app.add_flag("--resume", render.resume, "Go on where the last checkpoint is; the image is the same");
}

void addSamplingOptions(CLI::App& app, RenderArguments& render) {
  addInteger(app, "--spp", render.samplesPerPixel, 1, "Samples a pixel, instead of the scene's");
  const auto crop = [&render](const std::string& option, const std::string& text) {
    render.crop = parseCrop(text);
    if (!render.crop) refuse(option, fmt::format("'{}' is not four integers x,y,w,h, w and h at least 1", text));
  };
  addParsed(app, "--crop", "X,Y,W,H", crop, "Render these pixels alone, counted from the upper left corner");
  addMethodOptions(app, render);
}

void addRender(CLI::App& program, RenderArguments& render) {
  CLI::App& app = *program.add_subcommand("render", "Render a scene to image files");
  app.footer(renderExamples);
  app.add_option("scene", render.scene, "The scene, an XML file (see: aerosol help scene)")
      ->required()
      ->option_text(" ");
  addList(app, "-o,--output", "FILE", render.outputs,
          "Image to write, .exr, .png or .jpg; repeatable\n[the scene's name with .png, in the current folder]");
  addSceneOptions(app, render);
  addSamplingOptions(app, render);
  addPartOptions(app, render);
  addInteger(app, "--threads", render.threads, 1,
             "Threads that prepare and render [one a processor]; the image is the same", mostThreads);
  addInteger(app, "--texture-memory", render.textureMemory_MB, 16,
             "Megabytes for decoded texels of all threads [1024]; the image\nis the same");
  addKernelOptions(app, render.kernels);
  app.add_flag("--quiet,-q", render.quiet, "No progress; warnings and shader messages stay");
  app.add_flag("--watch", render.watch,
               "Start the image again whenever the scene or a shader changes; errors leave the last good one");
  app.add_flag_callback(
         "--stats", [&render] { render.statistics = true; },
         "Print statistics at the end; --stats FILE.json writes them")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  app.add_option("--stats-file", render.statisticsFile)->group("");
  app.add_flag("--explain-cost", render.explainCost, "Print where the time went: shader by shader, and all the rest");
  addAovOption(app, render.aovs);
  addDeepOptions(app, render.deep, true);
  addDisplayOptions(app, render.display);
  app.add_option("--tev", render.tev,
                 "Show the image while it is rendered in tev, a viewer that runs\nthere [port 14158]")
      ->option_text("HOST[:PORT]");
  app.add_flag("--count-lanes", render.countLanes, "Print statistics with the lanes used inside shaders (slower)");
}

/// Listed here; what stands behind their names is read by themselves.
void addTools(CLI::App& program) {
  program.add_subcommand("compile", "Check and compile shaders, and report about them, as OSL's oslc does");
  program.add_subcommand("info", "Show what shaders take and give, as OSL's oslinfo does");
  program.add_subcommand("shade", "Run shaders on a grid of points, as OSL's testshade does");
}

void addShaderPath(CLI::App& app, KernelArguments& kernels) {
  addList(app, "--shader-path", "DIR", kernels.shaderPath,
          "Look for shaders here first; repeatable. $AEROSOL_SHADER_PATH\n"
          "(folders between colons) comes next");
}

void addHelp(CLI::App& program, HelpArguments& help) {
  CLI::App& app = *program.add_subcommand("help", "Explain a command, the scene format, an object type or a shader");
  app.add_option("topic", help.topic, "A command, 'scene', an element or type of the scene format, or a shader")
      ->option_text(" ");
  addShaderPath(app, help.kernels);
}

/// The parser and what it fills.
struct Parser {
  CLI::App app{"Aerosol, a path tracer for scripted volumes", "aerosol"};
  RenderArguments render;
  MergeArguments merge;
  DenoiseArguments denoise;
  StudyArguments study;
  PlanArguments plan;
  DoctorArguments doctor;
  CheckArguments check;
  SubmitArguments submit;
  BakeArguments bake;
  HelpArguments help;
  bool version = false;

  Parser() {
    app.set_help_flag("-h,--help", "Show this help");
    app.get_formatter()->column_width(optionColumn);
    app.get_formatter()->label("OPTIONS", "OPTIONS");
    app.get_formatter()->label("SUBCOMMAND", "COMMAND");
    app.get_formatter()->label("Positionals", "Arguments");
    app.get_formatter()->label("Subcommands", "Commands");
    app.require_subcommand(0, 1);
    app.add_flag("--version", version, "Show the versions of the program and its libraries");
    addRender(app, render);
    addBake(app, bake);
    addMerge(app, merge);
    addDenoise(app, denoise);
    addStudy(app, study);
    addPlan(app, plan);
    addCheck(app, check);
    addDoctor(app, doctor);
    addSubmit(app, submit);
    addTools(app);
    addHelp(app, help);
    for (CLI::App* command : app.get_subcommands({})) command->group("Commands");
    app.footer(programExamples);  // Last, because commands inherit it.
  }

  bool chose(const char* command) const { return app.got_subcommand(command); }
  const CLI::App& chosen() const { return app.get_subcommands().empty() ? app : *app.get_subcommands().front(); }
};

Reply usageError(const std::string& message, const std::string& hint = {}) {
  std::string text = "aerosol: error: " + message + "\n";
  if (!hint.empty()) text += "  note: " + hint + "\n";
  return {ExitCode::usage, text};
}

/// What CLI11 says, in plainer words where it counts values.
std::string describe(const CLI::ParseError& error) {
  const std::string text = error.what();
  if (error.get_name() != "ArgumentMismatch") return text;
  const std::string option = text.substr(0, text.find(':'));
  return text.find("At Most") == std::string::npos ? option + " needs a value" : option + " is given more than once";
}

std::vector<std::string> optionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// An option, a command or one file too many.
Reply unexpected(const CLI::App& app, const std::string& argument) {
  const bool isProgram = app.get_parent() == nullptr;
  const std::string more = isProgram ? "aerosol --help" : "aerosol help " + app.get_name();
  if (argument.size() > 1 && argument[0] == '-') {
    const std::string name = argument.substr(0, argument.find('='));
    const std::string near = didYouMean(name, optionNames(app));
    return usageError(fmt::format("unknown option '{}'", name), near.empty() ? "see: " + more : near);
  }
  if (!isProgram) return usageError(fmt::format("unexpected argument '{}'", argument), "see: " + more);
  const std::string near = didYouMean(argument, commandNames());
  return usageError(fmt::format("unknown command '{}'", argument),
                    near.empty() ? fmt::format("commands are {}", fmt::join(commandNames(), ", ")) : near);
}

void appendSearchPath(std::string_view variable, std::vector<std::filesystem::path>& folders) {
  while (!variable.empty()) {
    const std::size_t colon = std::min(variable.find(':'), variable.size());
    if (colon > 0) folders.emplace_back(variable.substr(0, colon));
    variable.remove_prefix(std::min(colon + 1, variable.size()));
  }
}

/// `--stats FILE.json` and `--stats=FILE.json` name a file; `--stats` before anything else stands alone.
std::vector<std::string> nameStatisticsFile(const std::vector<std::string>& arguments) {
  std::vector<std::string> words;
  const auto isFile = [](const std::string& word) { return word.ends_with(".json") && word[0] != '-'; };
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--stats" && i + 1 < arguments.size() && isFile(arguments[i + 1])) {
      words.push_back("--stats-file=" + arguments[++i]);
    } else if (arguments[i].starts_with("--stats=")) {
      words.push_back("--stats-file=" + arguments[i].substr(8));
    } else {
      words.push_back(arguments[i]);
    }
  }
  return words;
}

}  // namespace

std::optional<Crop> parseCrop(std::string_view text) {
  std::vector<int> numbers;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    scene::TextError error;
    const std::optional<int> number = scene::parseInteger(text.substr(0, comma), error);
    if (!number) return {};
    numbers.push_back(*number);
    more = comma != std::string_view::npos;
    if (more) text.remove_prefix(comma + 1);
  }
  if (numbers.size() != 4) return {};
  const Crop crop{numbers[0], numbers[1], numbers[2], numbers[3]};
  if (crop.x < 0 || crop.y < 0 || crop.width < 1 || crop.height < 1) return {};
  return crop;
}

std::optional<SampleRange> parseSampleRange(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return {};
  scene::TextError error;
  const auto first = scene::parseInteger(text.substr(0, colon), error);
  const auto end = scene::parseInteger(text.substr(colon + 1), error);
  if (!first || !end || *first < 0 || *end <= *first) return {};
  return SampleRange{*first, *end};
}

std::vector<std::string> commandNames() {
  const Parser parser;
  std::vector<std::string> names;
  for (const CLI::App* command : parser.app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

std::string commandHelp(const std::string& command) {
  if (const auto tool = toolOfCommand(command)) return toolHelp(*tool);
  const Parser parser;
  return command.empty() ? parser.app.help() : parser.app.get_subcommand(command)->help("aerosol");
}

std::variant<Arguments, Reply> parseCommandLine(const std::vector<std::string>& arguments,
                                                std::string_view shaderPathVariable) {
  if (arguments.empty()) return Reply{ExitCode::usage, commandHelp({})};
  if (const auto tool = toolOfCommand(arguments.front())) {
    if (arguments.size() == 2 && (arguments[1] == "--help" || arguments[1] == "-h"))
      return Reply{ExitCode::success, toolHelp(*tool)};
    ToolArguments call{*tool, false, {arguments.begin() + 1, arguments.end()}, {}};
    appendSearchPath(shaderPathVariable, call.shaderPath);
    return Arguments(std::move(call));
  }
  Parser parser;
  const std::vector<std::string> words = nameStatisticsFile(arguments);
  try {
    parser.app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::CallForHelp&) {
    return Reply{ExitCode::success, parser.app.help()};
  } catch (const CLI::ExtrasError&) {
    return unexpected(parser.chosen(), parser.app.remaining(true).front());
  } catch (const CLI::ParseError& error) {
    const bool isProgram = &parser.chosen() == &parser.app;
    return usageError(describe(error),
                      isProgram ? "see: aerosol --help" : "see: aerosol help " + parser.chosen().get_name());
  }
  if (parser.version) return Arguments(VersionArguments{});
  for (KernelArguments* kernels : {&parser.render.kernels, &parser.bake.kernels, &parser.study.render.kernels,
                                   &parser.plan.render.kernels, &parser.doctor.render.kernels,
                                   &parser.check.render.kernels, &parser.submit.render.kernels, &parser.help.kernels}) {
    appendSearchPath(shaderPathVariable, kernels->shaderPath);
  }
  if (parser.chose("render")) return Arguments(std::move(parser.render));
  if (parser.chose("merge")) return Arguments(std::move(parser.merge));
  if (parser.chose("denoise")) return Arguments(std::move(parser.denoise));
  if (parser.chose("study")) return Arguments(std::move(parser.study));
  if (parser.chose("plan")) return Arguments(std::move(parser.plan));
  if (parser.chose("check")) return Arguments(std::move(parser.check));
  if (parser.chose("doctor")) return Arguments(std::move(parser.doctor));
  if (parser.chose("submit")) return Arguments(std::move(parser.submit));
  if (parser.chose("bake")) {
    if (const std::string problem = problemOf(parser.bake); !problem.empty())
      return usageError(problem, "see: aerosol help bake");
  }
  if (parser.chose("bake")) return Arguments(std::move(parser.bake));
  if (parser.chose("help")) return Arguments(std::move(parser.help));
  return usageError("no command is given", fmt::format("commands are {}", fmt::join(commandNames(), ", ")));
}

}  // namespace aerosol::app

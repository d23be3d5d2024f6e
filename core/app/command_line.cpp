#include "core/app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <utility>

#include "core/app/tools/tool.h"
#include "core/base/diagnostic.h"
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

Ctrl-C ends the render and writes what there is, with its number of samples in the file's metadata; pressed once more,
it ends the program at once.)";

/// Wide enough for the longest option, so that all texts stand in one column.
constexpr std::size_t optionColumn = 31;

[[noreturn]] void refuse(const std::string& option, const std::string& why) { throw CLI::ValidationError(option, why); }

/// An option whose text `parse` turns into a value, or refuses.
template <class Parse>
CLI::Option* addParsed(CLI::App& app, const std::string& names, const char* valueName, Parse parse, const char* help) {
  const std::string shown = names.substr(names.find("--"));
  return app
      .add_option_function<std::string>(
          names, [parse, shown](const std::string& text) { parse(shown, text); }, help)
      ->option_text(valueName);
}

template <class Target>
CLI::Option* addInteger(CLI::App& app, const std::string& names, Target& target, int minimum, const char* help) {
  const auto parse = [&target, minimum](const std::string& option, const std::string& text) {
    scene::TextError error;
    const std::optional<int> value = scene::parseInteger(text, error);
    if (!value) refuse(option, fmt::format("'{}' is not an integer", text));
    if (*value < minimum) refuse(option, fmt::format("must be at least {}, not {}", minimum, *value));
    target = *value;
  };
  return addParsed(app, names, "N", parse, help);
}

/// A list option that takes one value each time that it is given.
template <class T>
CLI::Option* addList(CLI::App& app, const std::string& names, const char* valueName, std::vector<T>& target,
                     const char* help) {
  return app.add_option(names, target, help)->allow_extra_args(false)->option_text(valueName);
}

void addShaderPath(CLI::App& app, KernelArguments& kernels) {
  addList(app, "--shader-path", "DIR", kernels.shaderPath,
          "Look for shaders here first; repeatable. $AEROSOL_SHADER_PATH\n"
          "(folders between colons) comes next");
}

void addKernelOptions(CLI::App& app, KernelArguments& kernels) {
  addShaderPath(app, kernels);
  const auto parseWidth = [&kernels](const std::string& option, const std::string& text) {
    if (text != "16" && text != "8" && text != "4" && text != "1") {
      refuse(option, fmt::format("'{}' is not one of 16, 8, 4, 1", text));
    }
    scene::TextError error;
    kernels.width = scene::parseInteger(text, error);
  };
  addParsed(app, "--width", "16|8|4|1", parseWidth,
            "Points that compiled shaders work on at once [best of the machine]");
  const auto parseIsa = [&kernels](const std::string& option, const std::string& text) {
    if (text != "avx2" && text != "avx512") refuse(option, fmt::format("'{}' is not one of avx2, avx512", text));
    kernels.isa = text;
  };
  addParsed(app, "--isa", "avx2|avx512", parseIsa, "Instruction set of shaders and ray queries [best of the machine]");
  app.add_flag_callback(
      "--no-cache", [&kernels] { kernels.useCache = false; }, "Compile all shaders anew, keep nothing");
}

void addSceneOptions(CLI::App& app, RenderArguments& render) {
  const auto define = [&render](const std::string& option, const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos) refuse("-D", fmt::format("'{}' is not NAME=VALUE", text));
    const auto [place, isNew] = render.defines.emplace(text.substr(0, equals), text.substr(equals + 1));
    if (!isNew) refuse(option, fmt::format("'{}' is given twice", place->first));
  };
  app.add_option_function<std::vector<std::string>>(
         "-D,--define",
         [define](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) define("-D", text);
         },
         "Give $NAME in the scene a value; repeatable")
      ->allow_extra_args(false)
      ->option_text("NAME=VALUE");
  addList(app, "--set", "TARGET.PARAMETER=VALUE", render.overrides,
          "Change a parameter after the scene is read; repeatable. TARGET\n"
          "is an id, a shader or a kind of object: cumulus.density=2,\n"
          "film.width=640, sun.irradiance=4; * is everything that has it");
}

std::optional<scene::DistanceSampling> parseDistance(const std::string& text) {
  if (text == "auto") return scene::DistanceSampling::automatic;
  if (text == "marching") return scene::DistanceSampling::marching;
  if (text == "null") return scene::DistanceSampling::nullScattering;
  return {};
}

void addSamplingOptions(CLI::App& app, RenderArguments& render) {
  addInteger(app, "--spp", render.samplesPerPixel, 1, "Samples a pixel, instead of the scene's");
  addInteger(app, "--seed", render.seed, 0, "Seed of all random numbers, instead of the scene's");
  const auto crop = [&render](const std::string& option, const std::string& text) {
    render.crop = parseCrop(text);
    if (!render.crop) refuse(option, fmt::format("'{}' is not four integers x,y,w,h, w and h at least 1", text));
  };
  addParsed(app, "--crop", "X,Y,W,H", crop, "Render these pixels alone, counted from the upper left corner");
  const auto distance = [&render](const std::string& option, const std::string& text) {
    render.distance = parseDistance(text);
    if (!render.distance) refuse(option, fmt::format("'{}' is not one of auto, marching, null", text));
  };
  addParsed(app, "--distance", "auto|marching|null", distance,
            "Sample distances in all media so, whatever the scene says: by\n"
            "ray marching or by null scattering");
  const auto stepScale = [&render](const std::string& option, const std::string& text) {
    scene::TextError error;
    render.stepScale = scene::parseFloat(text, error);
    if (!render.stepScale) refuse(option, fmt::format("'{}' is not a number", text));
    if (!(*render.stepScale > 0)) refuse(option, fmt::format("must be greater than 0, not {}", text));
  };
  addParsed(app, "--step-scale", "FACTOR", stepScale, "Multiply all ray marching steps, instead of the scene's factor");
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
  addInteger(app, "--threads", render.threads, 1,
             "Threads that prepare and render [one a processor]; the image is the same");
  addInteger(app, "--texture-memory", render.textureMemory_MB, 16,
             "Megabytes for decoded texels of all threads [1024]; the image\nis the same");
  addKernelOptions(app, render.kernels);
  app.add_flag("--quiet,-q", render.quiet, "No progress; warnings and shader messages stay");
  app.add_flag("--stats", render.statistics, "Print statistics at the end");
  app.add_flag("--count-lanes", render.countLanes, "Print statistics with the lanes used inside shaders (slower)");
}

/// Listed here; what stands behind their names is read by themselves.
void addTools(CLI::App& program) {
  program.add_subcommand("compile", "Check and compile shaders, and report about them, as OSL's oslc does");
  program.add_subcommand("info", "Show what shaders take and give, as OSL's oslinfo does");
  program.add_subcommand("shade", "Run shaders on a grid of points, as OSL's testshade does");
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
  try {
    parser.app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
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
  for (KernelArguments* kernels : {&parser.render.kernels, &parser.help.kernels}) {
    appendSearchPath(shaderPathVariable, kernels->shaderPath);
  }
  if (parser.chose("render")) return Arguments(std::move(parser.render));
  if (parser.chose("help")) return Arguments(std::move(parser.help));
  return usageError("no command is given", fmt::format("commands are {}", fmt::join(commandNames(), ", ")));
}

}  // namespace aerosol::app

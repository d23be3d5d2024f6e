#include "core/app/command_line.h"
#include "core/app/option_helpers.h"
#include "core/scene/integrator_reader.h"

// How pictures become those of a display, and the command that takes their noise away.

namespace aerosol::app {

void addDisplayOptions(CLI::App& app, image::DisplayOptions& display) {
  app.add_option("--ocio", display.config,
                 "OpenColorIO config for .png and .jpg [$OCIO, or else a built-in\n"
                 "one: display sRGB with the views sRGB, ACES 1.0 SDR and Raw]")
      ->option_text("FILE");
  app.add_option("--display", display.display, "The config's display [its default]")->option_text("NAME");
  app.add_option("--view", display.view, "The display's view [its default]")->option_text("NAME");
  app.add_option("--working-space", display.workingSpace,
                 "The config's colour space of the rendered values [its role\nscene_linear; the built-in config's is "
                 "linear Rec.709]")
      ->option_text("NAME");
  const auto exposure = [&display](const std::string& option, const std::string& text) {
    scene::TextError why;
    const auto number = scene::parseFloat(text, why);
    if (!number) refuse(option, fmt::format("'{}' is not a number of stops", text));
    display.exposure = *number;
  };
  addParsed(app, "--exposure", "STOPS", exposure, "Make .png and .jpg brighter: 1 doubles the light [0]");
}

void addAovOption(CLI::App& app, std::vector<scene::AovRequest>& aovs) {
  const auto aov = [&aovs](const std::string& option, const std::string& text) {
    for (const std::string& part : scene::splitAovList(text)) {
      const std::size_t equals = part.find('=');
      const std::string quantity = equals == std::string::npos ? part : part.substr(equals + 1);
      if (quantity.empty() || equals == 0) refuse(option, fmt::format("'{}' is not NAME or NAME=EXPRESSION", part));
      aovs.push_back({part.substr(0, equals), quantity, {}});
    }
  };
  app.add_option_function<std::vector<std::string>>(
         "--aov",
         [aov](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) aov("--aov", text);
         },
         "Add these layers to EXR files: direct, indirect, light_groups,\n"
         "albedo, depth, error, cost, … (all of them: aerosol help aovs),\n"
         "or light path expressions: --aov \"first=C<RD>L\"; repeatable")
      ->allow_extra_args(false)
      ->option_text("NAME[=EXPRESSION],...");
}

void addDeepOptions(CLI::App& app, DeepArguments& deep, bool gathers) {
  app.add_option("--deep", deep.file,
                 gathers ? "Write a deep image too: surfaces and media by depth, for\ncompositing; over each other "
                           "they are the picture"
                         : "Write the deep image too; the parts have to be renders with\n--deep")
      ->option_text("FILE.exr");
  const auto error = [&deep](const std::string& option, const std::string& text) {
    scene::TextError why;
    const auto number = scene::parseFloat(text, why);
    if (!number || !(*number >= 0)) refuse(option, fmt::format("'{}' is not a number of at least 0", text));
    deep.error = static_cast<double>(*number);
  };
  addParsed(app, "--deep-error", "E", error,
            "By which transmittance and light of a deep image may differ\nalong depth from what was gathered: fewer "
            "samples [0.002]");
  if (!gathers) return;
  addInteger(app, "--deep-slices", deep.slices, 1,
             "Slices of a deep image through media [32]; a pixel takes some\n60 bytes for each while it is rendered",
             4096);
}

void addDenoise(CLI::App& program, DenoiseArguments& denoise) {
  CLI::App& app = *program.add_subcommand("denoise", "Take the noise out of a render, by what is known of its pixels");
  app.footer(R"(Example:
  aerosol render cloud.xml -o cloud.exr --spp 32 --aov denoise
  aerosol denoise cloud.exr -o clean.exr -o clean.png

Each pixel becomes the best fit to those around it that look alike but for noise, over albedo, normal and depth of what
is seen (regression of first order with weights by non-local means). Two halves of the samples guide each other. What
the render does not know, such as a sharp shadow of few samples, is smoothed.)");
  app.add_option("input", denoise.input, "An EXR file of aerosol render --aov denoise")->required()->option_text(" ");
  addList(app, "-o,--output", "FILE", denoise.outputs, "Image to write, .exr, .png or .jpg; repeatable")->required();
  addInteger(app, "--radius", denoise.radius, 1, "Pixels: how far away others are looked for [9]", 50);
  const auto strength = [&denoise](const std::string& option, const std::string& text) {
    scene::TextError why;
    const auto number = scene::parseFloat(text, why);
    if (!number || !(*number > 0)) refuse(option, fmt::format("'{}' is not a number above 0", text));
    denoise.strength = *number;
  };
  addParsed(app, "--strength", "K", strength, "Standard deviations by which pixels that are alike may differ [0.5]");
  addInteger(app, "--threads", denoise.threads, 1, "Threads [one a processor]; the image is the same", mostThreads);
  addDisplayOptions(app, denoise.display);
  app.add_flag("--quiet,-q", denoise.quiet, "Say nothing but warnings and errors");
}

}  // namespace aerosol::app

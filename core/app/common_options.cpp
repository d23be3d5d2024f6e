#include <algorithm>

#include "core/app/option_helpers.h"
#include "core/scene/field.h"

// Options that several commands have.

namespace aerosol::app {

namespace {

/// A choice by its word in scenes.
template <class Choice>
void addChoice(CLI::App& app, const char* option, std::optional<Choice>& choice, const char* doc) {
  const auto parse = [&choice](const std::string& given, const std::string& text) {
    const auto& known = scene::Words<Choice>::words;
    const auto word = std::find(known.begin(), known.end(), text);
    if (word == known.end()) refuse(given, fmt::format("'{}' is not one of {}", text, fmt::join(known, ", ")));
    choice = static_cast<Choice>(word - known.begin());
  };
  addParsed(app, option, fmt::format("{}", fmt::join(scene::Words<Choice>::words, "|")).c_str(), parse, doc);
}

}  // namespace

void addKernelOptions(CLI::App& app, KernelArguments& kernels) {
  addList(app, "--shader-path", "DIR", kernels.shaderPath,
          "Look for shaders here first; repeatable. $AEROSOL_SHADER_PATH\n"
          "(folders between colons) comes next");
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
  addInteger(app, "--loop-budget", render.loopBudget, 1,
             "Rounds of one loop after which a point leaves it, which is reported [1048576]");
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
  app.add_option("--sensor", render.sensor, "Of several sensors: the one with this number, from 0, or id [the first]")
      ->option_text("N|ID");
  addList(app, "--set", "TARGET.PARAMETER=VALUE", render.overrides,
          "Change a parameter after the scene is read; repeatable. TARGET\n"
          "is an id, a shader or a kind of object: cumulus.density=2,\n"
          "film.width=640, sun.irradiance=4; * is everything that has it");
}

void addMethodOptions(CLI::App& app, RenderArguments& render) {
  addList(app, "--without", "EFFECT", render.without,
          "Force an effect off, whatever the scene says; repeatable. aerosol\nplan lists them");
  addInteger(app, "--seed", render.seed, 0, "Seed of all random numbers, instead of the scene's");
  addChoice(app, "--distance", render.distance,
            "Sample distances in all media so, whatever the scene says: by\n"
            "ray marching, by closed forms alone or by null scattering: null,\nrelaxed, decomposition, candidates; "
            "delta, under one bound for a\nwhole medium, is there to compare with");
  addChoice(app, "--transmittance", render.transmittance, "Estimate the transmittance of all media to lights so");
  app.add_flag("--no-equiangular", render.noEquiangular, "Choose no distances in media for the lights beside the rays");
  app.add_flag("--joint-lights", render.jointLights,
               "Choose them by lights and media together, tabulated along marched\nrays");
  app.add_option("--plan", render.plan,
                 "Sample all media as FILE says: an EXR image of the same scene,\nor the lines in its "
                 "aerosol:sampling, as text")
      ->option_text("FILE");
  const auto stepScale = [&render](const std::string& option, const std::string& text) {
    scene::TextError error;
    render.stepScale = scene::parseFloat(text, error);
    if (!render.stepScale) refuse(option, fmt::format("'{}' is not a number", text));
    if (!(*render.stepScale > 0)) refuse(option, fmt::format("must be greater than 0, not {}", text));
  };
  addParsed(app, "--step-scale", "FACTOR", stepScale, "Multiply all ray marching steps, instead of the scene's factor");
}

}  // namespace aerosol::app

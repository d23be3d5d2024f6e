// How options are added to commands. Internal to the command line.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/app/arguments.h"
#include "core/scene/value.h"

namespace aerosol::app {

[[noreturn]] inline void refuse(const std::string& option, const std::string& why) {
  throw CLI::ValidationError(option, why);
}

/// An option whose text `parse` turns into a value, or refuses.
template <class Parse>
CLI::Option* addParsed(CLI::App& app, const std::string& names, const char* valueName, Parse parse, const char* help) {
  const std::string shown = names.substr(names.find("--"));
  return app
      .add_option_function<std::string>(
          names, [parse, shown](const std::string& text) { parse(shown, text); }, help)
      ->option_text(valueName);
}

/// What no machine has; each thread takes some memory.
inline constexpr int mostThreads = 4096;

template <class Target>
CLI::Option* addInteger(CLI::App& app, const std::string& names, Target& target, int minimum, const char* help,
                        int maximum = std::numeric_limits<int>::max()) {
  const auto parse = [&target, minimum, maximum](const std::string& option, const std::string& text) {
    scene::TextError error;
    const std::optional<int> value = scene::parseInteger(text, error);
    if (!value) refuse(option, fmt::format("'{}' is not an integer", text));
    if (*value < minimum) refuse(option, fmt::format("must be at least {}, not {}", minimum, *value));
    if (*value > maximum) refuse(option, fmt::format("must be at most {}, not {}", maximum, *value));
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

/// A number of seconds: 90, 90s, 5m or 2h.
inline std::optional<double> parseSeconds(std::string_view text) {
  double unit = 1;
  if (!text.empty() && (text.back() == 's' || text.back() == 'm' || text.back() == 'h')) {
    unit = text.back() == 's' ? 1 : text.back() == 'm' ? 60 : 3600;
    text.remove_suffix(1);
  }
  scene::TextError error;
  const std::optional<float> number = scene::parseFloat(text, error);
  if (!number || !(*number >= 0)) return {};
  return static_cast<double>(*number) * unit;
}

/// Scene, -D, --set.
void addSceneOptions(CLI::App& app, RenderArguments& render);
/// --shader-path, --width, --isa, --no-cache.
void addKernelOptions(CLI::App& app, KernelArguments& kernels);
/// --seed, --distance, --step-scale: what changes the image, but for the number of samples.
void addMethodOptions(CLI::App& app, RenderArguments& render);

/// --ocio, --display, --view, --working-space, --exposure.
void addDisplayOptions(CLI::App& app, image::DisplayOptions& display);
/// --aov.
void addAovOption(CLI::App& app, std::vector<scene::AovRequest>& aovs);
/// --deep, --deep-error; `gathers`: also --deep-slices.
void addDeepOptions(CLI::App& app, DeepArguments& deep, bool gathers);
void addDenoise(CLI::App& program, DenoiseArguments& denoise);
void addMerge(CLI::App& program, MergeArguments& merge);
void addStudy(CLI::App& program, StudyArguments& study);
void addPlan(CLI::App& program, PlanArguments& plan);
void addSubmit(CLI::App& program, SubmitArguments& submit);
void addDoctor(CLI::App& program, DoctorArguments& doctor);
void addCheck(CLI::App& program, CheckArguments& check);

}  // namespace aerosol::app

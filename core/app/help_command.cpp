#include "core/app/help_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/app/command_line.h"
#include "core/app/plan/features.h"
#include "core/app/registered_types.h"
#include "core/app/shader_page.h"
#include "core/app/toolchain.h"
#include "core/render/aov/aov_table.h"
#include "core/scene/documentation.h"
#include "plugins/registration.h"

namespace aerosol::app {

namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Elements and types of the scene format.
std::vector<std::string> sceneTopics(const scene::KnownTypes& types) {
  std::vector<std::string> topics;
  for (const scene::ObjectDoc& object : scene::objectDocs(types)) {
    if (!contains(topics, object.tag)) topics.push_back(object.tag);
    const bool isPlaceholder = object.type == "SHADER";
    if (!isPlaceholder && !contains(topics, object.type)) topics.push_back(object.type);
  }
  return topics;
}

/// The scene format's pages and the shader of that name: 'sphere' may well be both.
std::string pages(const std::string& topic, const scene::KnownTypes& types, shading::ShaderLibrary& shaders,
                  Diagnostics& errors) {
  std::string text = scene::documentation(types, topic == "scene" ? "" : topic);
  if (contains(shaders.names(), topic)) {
    Diagnostics warnings;
    const auto program = shaders.find(topic, {}, warnings);
    if (!program) {
      errors.append(program.errors());
      return text;
    }
    text += (text.empty() ? "" : "\n") + shaderPage(**program);
  }
  return text;
}

Diagnostic unknownTopic(const std::string& topic, const scene::KnownTypes& types,
                        const shading::ShaderLibrary& shaders) {
  const std::vector<std::string> commands = commandNames(), objects = sceneTopics(types), known = shaders.names();
  std::vector<std::string> all{"scene", "aovs", "effects"};
  for (const auto* list : {&commands, &objects, &known}) all.insert(all.end(), list->begin(), list->end());
  Diagnostic error{Severity::error, {}, fmt::format("there is no help on '{}'", topic), {}, {}};
  if (const std::string near = didYouMean(topic, all); !near.empty()) error.notes.push_back(near);
  error.notes.push_back(fmt::format("commands: {}", fmt::join(commands, ", ")));
  error.notes.push_back(fmt::format("scene format: scene, aovs, effects, {}", fmt::join(objects, ", ")));
  if (!known.empty()) error.notes.push_back(fmt::format("shaders: {}", fmt::join(known, ", ")));
  return error;
}

}  // namespace

namespace {

/// What --aov takes.
std::string aovPage() {
  std::string text =
      "Layers of EXR files beside the picture: aerosol render --aov NAME,NAME,… or, in a scene,\n"
      "<integrator type=\"aov\"><string name=\"aovs\" value=\"LAYER:NAME,…\"/> around the integrator.\n"
      "Each is a part of the file with channels such as direct.R.\n\n";
  for (const render::AovType& type : render::aovTypes()) {
    if (type.isListed) text += fmt::format("  {:<24} {:<4} {}\n", type.name, type.channels, type.doc);
  }
  text +=
      "\nNAME=debug:OUTPUT shows what surface shaders give to an output: Ci += value * debug(\"OUTPUT\"); and of\n"
      "volume shaders their output parameter of that name, where a path first scatters in their medium.\n"
      "\nNAME=EXPRESSION names a light path expression, in the notation of OSL: events from the camera to the light.\n"
      "  <TSL>  one event: T is C camera, R reflection, T transmission, V volume, L light, B background, O another\n"
      "         thing that shines; S is D diffuse, G glossy, S singular, s straight; L a 'label', the light_group of\n"
      "         an emitter, or a closure's: diffuse(N, \"label\", \"paint\"). What is left out may be anything; R\n"
      "         alone is <R.>, D alone <.D>.\n"
      "  .  [RT]  [^D]  (…)  |  *  +  ?  {n,m}    as in regular expressions\n"
      "Any number of straight passings in a row is one event s. Scattering in media has no letter S of its own; media\n"
      "that shine are <OV>. Layers of media, surfaces and background add up to the picture, as do direct and "
      "indirect.\n\n"
      "Examples:\n"
      "  --aov direct,indirect,albedo,sh_normal,depth\n"
      "  --aov \"mirrored=CS+[LOB], key_in_fog=CV+<L.'key'>\"\n";
  return text;
}

}  // namespace

ExitCode helpCommand(const HelpArguments& arguments, const Console& console) {
  const std::string& topic = arguments.topic;
  if (topic.empty() || contains(commandNames(), topic)) {
    console.print(commandHelp(topic));
    return ExitCode::success;
  }
  if (topic == "effects") {
    console.print(effectsPage());
    return ExitCode::success;
  }
  if (topic == "aovs") {
    console.print(aovPage());
    return ExitCode::success;
  }
  const auto installation = findInstallation();
  if (!installation) {
    console.report(installation.errors());
    return ExitCode::badInput;
  }
  render::Registry registry;
  render::registerPlugins(registry);
  const scene::KnownTypes types = registeredTypes(registry);
  Diagnostics problems;
  shading::ShaderLibrary shaders =
      openShaderLibrary(arguments.kernels, *installation, openCache(arguments.kernels, problems));
  const std::string text = pages(topic, types, shaders, problems);
  console.print(text);
  console.report(problems);
  if (!text.empty()) return ExitCode::success;
  if (problems.hasErrors()) return ExitCode::badInput;
  console.report(unknownTopic(topic, types, shaders));
  return ExitCode::usage;
}

}  // namespace aerosol::app

#include "core/app/tools/shade_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "core/app/quantity.h"
#include "core/app/toolchain.h"
#include "core/app/tools/group_text.h"
#include "core/app/tools/osl_form.h"
#include "core/app/tools/shade_arguments.h"
#include "core/app/tools/shade_group.h"
#include "core/app/tools/shade_host.h"
#include "core/app/tools/shade_messages.h"
#include "core/app/tools/shade_outputs.h"
#include "core/app/tools/shade_run.h"

namespace aerosol::app {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// An output asked for, and where it is in the result.
struct Chosen {
  const ShadeOutput* request;
  std::string label;  ///< Without the layer.
  std::size_t index;
};

class ShadeRun {
 public:
  ShadeRun(const ShadeArguments& arguments, bool isTestshade, const Console& console)
      : arguments_(arguments), isTestshade_(isTestshade), console_(console) {}

  ExitCode run();

 private:
  bool prepare();
  std::optional<GridShader> makeShader(bool isChanged);
  void describeGroup() const;
  bool archive() const;
  void noteIgnored() const;
  void announce() const;
  std::vector<Chosen> chooseOutputs(const Shaded& shaded) const;
  bool write(const Shaded& shaded, const std::vector<Chosen>& chosen) const;
  void printStatistics(double setup, double run, double writing) const;
  void report(const Diagnostics& diagnostics) const { reportAsTestshade(diagnostics, console_); }

  const ShadeArguments& arguments_;
  bool isTestshade_;
  const Console& console_;
  std::optional<Toolchain> toolchain_;
  std::optional<ShadeGroup> group_;
};

void ShadeRun::noteIgnored() const {
  if (isTestshade_ && !arguments_.verbose) return;
  for (const std::string& option : arguments_.ignored)
    console_.note(fmt::format("note: {} means nothing here and is ignored\n", option));
}

/// The group's program, ready to run; `isChanged`: with the parameters that --reparam gives.
std::optional<GridShader> ShadeRun::makeShader(bool isChanged) {
  std::vector<std::filesystem::path> folders(arguments_.shaderPath.begin(), arguments_.shaderPath.end());
  std::ranges::copy(arguments_.kernels.shaderPath, std::back_inserter(folders));
  folders.push_back(toolchain_->installation.shaders);
  folders.push_back(toolchain_->installation.plugins);
  lang::CompileOptions options;
  options.includePaths = folders;
  options.standardLibrary = toolchain_->installation.shaders / "stdosl.h";
  std::vector<std::filesystem::path> pluginFolders = {""};
  std::ranges::copy(folders, std::back_inserter(pluginFolders));
  options.natives = openPlugins(pluginFolders);
  auto group = buildShadeGroup(arguments_, folders, options, isChanged);
  if (!group) {
    report(group.errors());
    return {};
  }
  if (!isChanged) {
    report(group->warnings);
    group_ = std::move(*group);
  }
  const ShadeGroup& made = isChanged ? *group : *group_;
  folders.resize(folders.size() - 2);
  folders.insert(folders.begin(), "");
  auto shader =
      GridShader::create(*toolchain_, made.program, made.values, makeShadeHost(arguments_, std::move(folders), made));
  if (!shader) {
    report(shader.errors());
    return {};
  }
  return std::move(*shader);
}

/// The group as text, its layers and their parameters.
void ShadeRun::describeGroup() const {
  if (!arguments_.verbose && !arguments_.query) return;
  console_.print(fmt::format("Shader group:\n---\n{}\n---\n\nShader group \"{}\" layers are:\n",
                             printGroupText(group_->requests, group_->connections), group_->name));
  for (const ShadeGroup::Layer& layer : group_->layers) {
    console_.print(fmt::format("    {}\n", layer.name));
    if (!arguments_.query) continue;
    for (const lang::Parameter& parameter : layer.program->parameters)
      console_.print(fmt::format("\t{}{} {}\n", parameter.isOutput ? "output " : "", lang::toString(parameter.type),
                                 parameter.name));
  }
  console_.print("\n");
}

bool ShadeRun::archive() const {
  if (arguments_.archive.empty()) return true;
  std::ofstream file(arguments_.archive, std::ios::binary);
  file << printGroupText(group_->requests, group_->connections);
  file.close();
  if (file) return true;
  console_.report(Diagnostic{Severity::error, {arguments_.archive, 0, 0}, "cannot write this file", {}, {}});
  return false;
}

bool ShadeRun::prepare() {
  Diagnostics warnings;
  auto toolchain = openToolchain(arguments_.kernels, warnings);
  report(warnings);
  if (!toolchain) {
    report(toolchain.errors());
    return false;
  }
  toolchain_ = std::move(*toolchain);
  return true;
}

/// The connections, and the outputs to files, as testshade tells them before anything is run.
void ShadeRun::announce() const {
  for (const ShadeConnection& c : arguments_.connections)  // Those of a group's text go without saying.
    console_.print(fmt::format("Connect {}.{} to {}.{}\n", c.fromLayer, c.fromOutput, c.toLayer, c.toInput));
  describeGroup();
  if (!arguments_.outputs.empty()) console_.print("\n");
  printRemarks(group_->remarks, console_);
  if (arguments_.entryLayers.empty()) return;
  console_.print("Entry layers:");
  for (const std::string& entry : arguments_.entryLayers) {
    const auto found = std::ranges::find(group_->layers, entry, &ShadeGroup::Layer::name);
    console_.print(fmt::format(" {}({})", entry, found - group_->layers.begin()));
  }
  console_.print("\n");
}

std::vector<Chosen> ShadeRun::chooseOutputs(const Shaded& shaded) const {
  std::vector<Chosen> chosen;
  for (const ShadeOutput& output : arguments_.outputs) {
    const auto name = group_->findOutput(output.variable);
    if (name) {
      const auto found = std::ranges::find(shaded.outputs, *name, &ShadedOutput::name);
      if (found == shaded.outputs.end()) continue;
      const bool isWhole = output.variable == *name;
      chosen.push_back({&output, isWhole ? name->substr(name->find('.') + 1) : output.variable,
                        static_cast<std::size_t>(found - shaded.outputs.begin())});
      if (output.file != "null") console_.print(fmt::format("Output {} to {}\n", output.variable, output.file));
    } else if (!isTestshade_ || arguments_.verbose) {
      std::fflush(console_.out);
      const std::vector<std::string> known = group_->outputs();
      console_.report(Diagnostic{
          Severity::warning,
          {},
          fmt::format("there is no output '{}'", output.variable),
          {},
          {known.empty() ? "the shader has no outputs" : fmt::format("outputs are {}", fmt::join(known, ", "))}});
    }
  }
  return chosen;
}

bool ShadeRun::write(const Shaded& shaded, const std::vector<Chosen>& chosen) const {
  bool allWritten = true;
  if (arguments_.printValues) return true;
  for (const Chosen& each : chosen) {
    if (each.request->file == "null") continue;
    const Diagnostics errors =
        writeShadedImage(arguments_.grid, shaded.outputs[each.index], each.request->file, arguments_.dataFormat);
    report(errors);
    allWritten = allWritten && !errors.hasErrors();
  }
  return allWritten;
}

void ShadeRun::printStatistics(double setup, double run, double writing) const {
  if (!arguments_.statistics) return;
  console_.print(fmt::format("\nSetup : {}\nRun   : {}\nWrite : {}\n", formatDuration(setup), formatDuration(run),
                             formatDuration(writing)));
  const double points = static_cast<double>(arguments_.grid.width) * arguments_.grid.height * arguments_.iterations;
  if (points > 0) console_.print(fmt::format("A point: {:.3g} ns\n", 1e9 * run / points));
}

ExitCode ShadeRun::run() {
  const Clock::time_point begin = Clock::now();
  noteIgnored();
  if (!prepare()) return ExitCode::badInput;
  auto shader = makeShader(false);
  if (!shader) return ExitCode::badInput;
  announce();
  if (!archive()) return ExitCode::badInput;
  const std::vector<Chosen> chosen = chooseOutputs(shader->emptyOutputs({}));
  const double setup = secondsSince(begin);

  const Clock::time_point started = Clock::now();
  Shaded shaded;
  std::vector<ShadedMessage> messages;
  for (int i = 0; i < arguments_.iterations; ++i) {
    if (i == 1 && !arguments_.reparameters.empty()) {
      shader = makeShader(true);
      if (!shader) return ExitCode::badInput;
    }
    shaded = shader->run(arguments_.grid, arguments_.threads);
    std::ranges::move(shaded.messages, std::back_inserter(messages));
  }
  const double running = secondsSince(started);

  const Clock::time_point writing = Clock::now();
  if (arguments_.printValues && arguments_.iterations > 0) {
    std::vector<PrintedOutput> printed;
    for (const Chosen& each : chosen) printed.push_back({each.label, each.index});
    printShadedValues(arguments_.grid, shaded, printed, console_);
  }
  console_.report(printShadedMessages(messages, *group_, console_));
  // Without an output asked for, testshade ends with an empty line.
  if (arguments_.outputs.empty() || (arguments_.outputs.size() == 1 && arguments_.outputs[0].file == "null"))
    console_.print("\n");
  const bool written = arguments_.iterations == 0 || write(shaded, chosen);
  printStatistics(setup, running, secondsSince(writing));
  return written ? ExitCode::success : ExitCode::badInput;
}

}  // namespace

ExitCode shadeCommand(const ToolArguments& arguments, const Console& console) {
  auto parsed = parseShadeArguments(arguments.words);
  if (const Reply* reply = std::get_if<Reply>(&parsed)) {
    reply->code == ExitCode::success ? console.print(reply->text) : console.note(reply->text);
    return reply->code;
  }
  ShadeArguments& shade = std::get<ShadeArguments>(parsed);
  std::ranges::copy(arguments.shaderPath, std::back_inserter(shade.kernels.shaderPath));
  return ShadeRun(shade, arguments.isOsl, console).run();
}

}  // namespace aerosol::app

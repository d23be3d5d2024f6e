#include "core/app/tools/shade_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "core/app/quantity.h"
#include "core/app/toolchain.h"
#include "core/app/tools/osl_form.h"
#include "core/app/tools/shade_arguments.h"
#include "core/app/tools/shade_group.h"
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
  std::size_t index;
};

class ShadeRun {
 public:
  ShadeRun(const ShadeArguments& arguments, bool isTestshade, const Console& console)
      : arguments_(arguments), isTestshade_(isTestshade), console_(console) {}

  ExitCode run();

 private:
  bool prepare();
  void noteIgnored() const;
  void announce() const;
  std::vector<Chosen> chooseOutputs(const GridShader& shader) const;
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

bool ShadeRun::prepare() {
  Diagnostics warnings;
  auto toolchain = openToolchain(arguments_.kernels, warnings);
  report(warnings);
  if (!toolchain) {
    report(toolchain.errors());
    return false;
  }
  toolchain_ = std::move(*toolchain);
  KernelArguments kernels = arguments_.kernels;
  kernels.shaderPath.insert(kernels.shaderPath.begin(), arguments_.shaderPath.begin(), arguments_.shaderPath.end());
  shading::ShaderLibrary library = openShaderLibrary(kernels, toolchain_->installation, toolchain_->cache);
  auto group = buildShadeGroup(arguments_, library);
  if (!group) {
    report(group.errors());
    return false;
  }
  group_ = std::move(*group);
  report(group_->warnings);
  return true;
}

/// The connections, and the outputs to files, as testshade tells them before anything is run.
void ShadeRun::announce() const {
  for (const ShadeConnection& c : arguments_.connections)
    console_.print(fmt::format("Connect {}.{} to {}.{}\n", c.fromLayer, c.fromOutput, c.toLayer, c.toInput));
  if (!arguments_.outputs.empty()) console_.print("\n");
}

std::vector<Chosen> ShadeRun::chooseOutputs(const GridShader& shader) const {
  std::vector<Chosen> chosen;
  std::vector<std::string> known;
  for (const lang::Parameter& parameter : shader.program().parameters)
    if (parameter.isOutput && !parameter.type.closure) known.push_back(parameter.name);
  for (const ShadeOutput& output : arguments_.outputs) {
    const std::size_t dot = output.variable.find('.');
    const bool named = dot != std::string::npos && output.variable.substr(0, dot) == group_->layers.back();
    const auto found = std::ranges::find(known, named ? output.variable.substr(dot + 1) : output.variable);
    if (found != known.end()) {
      chosen.push_back({&output, static_cast<std::size_t>(found - known.begin())});
      if (output.file != "null") console_.print(fmt::format("Output {} to {}\n", output.variable, output.file));
    } else if (!isTestshade_ || arguments_.verbose) {
      std::fflush(console_.out);
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
  if (!arguments_.statistics && !arguments_.debug) return;
  console_.print(fmt::format("\nSetup : {}\nRun   : {}\nWrite : {}\n", formatDuration(setup), formatDuration(run),
                             formatDuration(writing)));
  const double points = static_cast<double>(arguments_.grid.width) * arguments_.grid.height * arguments_.iterations;
  if (points > 0) console_.print(fmt::format("A point: {:.3g} ns\n", 1e9 * run / points));
}

ExitCode ShadeRun::run() {
  const Clock::time_point begin = Clock::now();
  noteIgnored();
  if (!prepare()) return ExitCode::badInput;
  auto shader = GridShader::create(*toolchain_, group_->program, group_->values);
  if (!shader) {
    report(shader.errors());
    return ExitCode::badInput;
  }
  announce();
  const std::vector<Chosen> chosen = chooseOutputs(*shader);
  const double setup = secondsSince(begin);

  const Clock::time_point started = Clock::now();
  Shaded shaded;
  std::vector<ShadedMessage> messages;
  for (int i = 0; i < arguments_.iterations; ++i) {
    shaded = shader->run(arguments_.grid, arguments_.threads);
    std::ranges::move(shaded.messages, std::back_inserter(messages));
  }
  const double running = secondsSince(started);

  const Clock::time_point writing = Clock::now();
  if (arguments_.printValues && arguments_.iterations > 0) {
    std::vector<std::size_t> indices;
    for (const Chosen& each : chosen) indices.push_back(each.index);
    printShadedValues(arguments_.grid, shaded, indices, console_);
  }
  const auto last = group_->layers.size() - 1;
  printShadedMessages(messages, {group_->name, group_->layers[last], group_->shaders[last], static_cast<int>(last)},
                      console_);
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

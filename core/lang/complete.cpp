#include "core/lang/lower.h"

#include <algorithm>

#include "core/lang/analysis.h"

namespace aerosol::lang {

namespace {

/// A variable that nothing writes any more: it holds 0.
void makeZero(Program& program, VariableId id) {
  if (id == noVariable) return;
  program.variables[id].storage = Storage::constant;
  program.variables[id].value = std::vector<std::int32_t>{0};
}

bool writes(const Program& program, const Code& code, VariableId id) {
  return std::any_of(code.begin(), code.end(), [&](const Instruction& instruction) {
    bool found = false;
    forEachWritten(program, instruction, [&](VariableId written) { found = found || written == id; });
    return found || std::any_of(instruction.bodies.begin(), instruction.bodies.end(),
                                [&](const Code& body) { return writes(program, body, id); });
  });
}

}  // namespace

std::optional<std::uint32_t> onlyClosureOutput(const Program& program) {
  std::optional<std::uint32_t> only;
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) {
    const Parameter& parameter = program.parameters[i];
    if (!parameter.isOutput || parameter.type != types::closure || parameter.variable == noVariable) continue;
    if (only) return {};
    only = i;
  }
  return only;
}

Program complete(Program layer, const ReportAt& report) {
  if (layer.ci != noVariable && !writes(layer, layer.body, layer.ci)) {
    if (const auto output = onlyClosureOutput(layer)) layer.ci = layer.parameters[*output].variable;
  }
  std::vector<std::uint32_t> indices;
  std::vector<Parameter> kept;
  for (Parameter& parameter : layer.parameters) {
    makeZero(layer, parameter.isConnected);
    parameter.isConnected = noVariable;
    indices.push_back(static_cast<std::uint32_t>(kept.size()));
    if (parameter.type.closure) {
      makeZero(layer, parameter.isSet);
      if (parameter.variable != noVariable) layer.variables[parameter.variable].storage = Storage::local;
    } else {
      kept.push_back(std::move(parameter));
    }
  }
  layer.parameters = std::move(kept);
  for (Variable& variable : layer.variables)
    if (variable.storage == Storage::parameter) variable.parameter = indices[variable.parameter];
  for (Output& output : layer.outputs)
    if (output.kind == OutputKind::parameter) output.index = indices[output.index];
  expandClosures(layer, report);
  return layer;
}

}  // namespace aerosol::lang

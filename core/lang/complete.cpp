#include "core/lang/lower.h"

namespace aerosol::lang {

namespace {

/// A variable that nothing writes any more: it holds 0.
void makeZero(Program& program, VariableId id) {
  if (id == noVariable) return;
  program.variables[id].storage = Storage::constant;
  program.variables[id].value = std::vector<std::int32_t>{0};
}

}  // namespace

Program complete(Program layer, const ReportAt& report) {
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

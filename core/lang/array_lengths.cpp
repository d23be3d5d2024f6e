#include "core/lang/array_lengths.h"

#include <algorithm>
#include <utility>

#include "core/lang/group_names.h"

namespace aerosol::lang {

namespace {

/// Metadata with a name that no source can give.
constexpr std::string_view unsizedMark = "declared without a length";

/// Of a field of a structure: that of the structure.
std::string wholeName(const std::string& parameter) { return parameter.substr(0, parameter.find('.')); }

const Parameter* findParameter(const Program& program, const std::string& name) {
  const auto found = std::ranges::find(program.parameters, name, &Parameter::name);
  return found == program.parameters.end() ? nullptr : &*found;
}

/// Takes note when something of type `given` for the parameter asks for another length than it has.
void fit(const Program& program, const std::string& name, const Type& given, ArrayLengths& lengths) {
  const Parameter* const parameter = findParameter(program, name);
  if (!parameter || !isUnsized(*parameter) || !given.isArray()) return;
  if (sameKind(given.element(), parameter->type.element()) && given.arrayLength != parameter->type.arrayLength)
    lengths[wholeName(name)] = given.arrayLength;
}

}  // namespace

bool isUnsized(const Parameter& parameter) {
  return std::ranges::any_of(parameter.metadata, [](const MetadataValue& entry) { return entry.name == unsizedMark; });
}

bool isUnsized(const VariableDeclaration& parameter) {
  return parameter.arrayLength == Type::unsized && !parameter.lengthExpression;
}

std::vector<std::string> setArrayLengths(SourceFile& file, const ArrayLengths& lengths) {
  std::vector<std::string> names;
  for (auto& declaration : file.declarations) {
    auto* const shader = std::get_if<std::unique_ptr<ShaderDeclaration>>(&declaration);
    if (!shader) continue;
    names.clear();  // The last shader of the file is the shader.
    for (const auto& parameter : (*shader)->parameters) {
      if (!isUnsized(*parameter)) continue;
      names.push_back(parameter->name);
      const auto given = lengths.find(parameter->name);
      if (given == lengths.end()) continue;
      parameter->arrayLength = given->second;
      auto* const list = parameter->initializer ? std::get_if<InitializerList>(&parameter->initializer->node) : nullptr;
      const auto count = static_cast<std::size_t>(given->second);
      if (list && list->elements.size() > count) list->elements.resize(count);
    }
  }
  return names;
}

void markUnsized(Program& program, const std::vector<std::string>& names) {
  for (Parameter& parameter : program.parameters)
    if (std::ranges::find(names, wholeName(parameter.name)) != names.end())
      parameter.metadata.push_back({std::string(unsizedMark), types::integer, std::vector<std::int32_t>{1}});
}

Diagnostics fitArrays(
    Group& group,
    const std::function<Result<std::shared_ptr<const Program>>(std::size_t, const ArrayLengths&)>& recompile) {
  Diagnostics errors;
  for (std::size_t i = 0; i < group.layers.size(); ++i) {
    GroupLayer& layer = group.layers[i];
    if (std::ranges::none_of(layer.program->parameters, [](const Parameter& p) { return isUnsized(p); })) continue;
    ArrayLengths lengths;
    for (const GivenValue& value : layer.values) fit(*layer.program, value.parameter, value.type, lengths);
    for (const Connection& connection : group.connections) {
      if (connection.layer != layer.name) continue;
      const auto source = std::ranges::find(group.layers, connection.sourceLayer, &GroupLayer::name);
      if (source == group.layers.end()) continue;
      if (const Parameter* const output = findParameter(*source->program, connection.source))
        fit(*layer.program, connection.parameter, output->type, lengths);
    }
    if (lengths.empty()) continue;
    auto program = recompile(i, lengths);
    if (program) {
      layer.program = std::move(*program);
    } else {
      errors.append(program.errors());
    }
  }
  return errors;
}

}  // namespace aerosol::lang

#include "core/render/group_binding.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/lang/group_names.h"
#include "core/lang/group_text.h"

namespace aerosol::render {

Result<lang::Group> GroupBuilder::build(const scene::ShaderUse& shader) {
  const bool isGroup = shader.code && shader.code->isGroup;
  add(shader, isGroup || shader.code ? "shader" : shader.name, true);
  if (errors_.hasErrors()) return errors_;
  return std::move(group_);
}

std::string GroupBuilder::uniqueName(const std::string& wanted) const {
  const auto isTaken = [&](const std::string& name) {
    return std::any_of(group_.layers.begin(), group_.layers.end(),
                       [&](const lang::GroupLayer& layer) { return layer.name == name; });
  };
  std::string name = wanted;
  for (int i = 2; isTaken(name); ++i) name = wanted + std::to_string(i);
  return name;
}

std::optional<GroupBuilder::Range> GroupBuilder::add(const scene::ShaderUse& use, const std::string& name,
                                                     bool isWhole) {
  std::vector<std::optional<Range>> inputs;
  for (const scene::ShaderInput& input : use.inputs) {
    const scene::ShaderUse& layer = layers_[input.layer];
    if (const auto known = known_.find(input.layer); known != known_.end()) {
      inputs.push_back(known->second);
      continue;
    }
    const std::string fallback = input.parameter.empty() ? layer.name : input.parameter;
    inputs.push_back(add(layer, layer.origin.id.empty() ? fallback : layer.origin.id, false));
    known_[input.layer] = inputs.back();
  }
  const std::size_t first = group_.layers.size();
  if (!addLayers(use, name, isWhole)) return std::nullopt;
  const Range range{first, group_.layers.size() - 1};
  setValues(use, range);
  connect(use, range, inputs);
  return range;
}

bool GroupBuilder::addLayers(const scene::ShaderUse& use, const std::string& name, bool isWhole) {
  if (use.code && use.code->isGroup) return addGroupText(use, isWhole ? "" : uniqueName(name) + ".");
  auto program = !use.code                ? library_.findLayer(use.name, use.nameLocation, warnings_)
                 : use.code->file.empty() ? library_.compileLayer(use.code->text, use.code->location, warnings_)
                                          : library_.loadLayer(use.code->file, warnings_);
  if (!program) {
    errors_.append(program.errors());
    return false;
  }
  group_.layers.push_back({uniqueName(name), std::move(*program), {}, use.origin.location});
  return true;
}

bool GroupBuilder::addGroupText(const scene::ShaderUse& use, const std::string& prefix) {
  const auto text = lang::parseGroup(use.code->text, use.code->location);
  if (!text) {
    errors_.append(text.errors());
    return false;
  }
  if (text->layers.empty()) {
    errors_.error(use.code->location, "this shader group has no layer: write shader NAME LAYER");
    return false;
  }
  auto group = shading::loadGroup(*text, "", library_, warnings_);
  if (!group) {
    errors_.append(group.errors());
    return false;
  }
  for (lang::GroupLayer& layer : group->layers) {
    layer.name = prefix + layer.name;
    group_.layers.push_back(std::move(layer));
  }
  for (lang::Connection& connection : group->connections) {
    connection.sourceLayer = prefix + connection.sourceLayer;
    connection.layer = prefix + connection.layer;
    group_.connections.push_back(std::move(connection));
  }
  return true;
}

/// The layer that a parameter's name means: of a group `layer.parameter`, or its last layer's own. `parameter` becomes
/// the name in that layer.
lang::GroupLayer* GroupBuilder::layerOf(const std::string& name, Range range, std::string& parameter) {
  parameter = name;
  if (range.first != range.last) {
    for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', dot + 1)) {
      for (std::size_t i = range.first; i <= range.last; ++i) {
        const std::string& layer = group_.layers[i].name;
        if (layer != name.substr(0, dot) && !layer.ends_with("." + name.substr(0, dot))) continue;
        parameter = name.substr(dot + 1);
        return &group_.layers[i];
      }
    }
  } else if (const std::string& own = group_.layers[range.first].name; name.starts_with(own + ".")) {
    // A group of one layer; structures of the layer's name are not meant.
    if (!lang::ParameterNames(*group_.layers[range.first].program).find(name)) parameter = name.substr(own.size() + 1);
  }
  return &group_.layers[range.last];
}

void GroupBuilder::setValues(const scene::ShaderUse& use, Range range) {
  for (const scene::ShaderParameter& written : use.parameters) {
    scene::ShaderParameter inLayer = written;
    lang::GroupLayer* layer = layerOf(written.name, range, inLayer.name);
    if (auto value = givenValue(*layer->program, inLayer, errors_)) layer->values.push_back(std::move(*value));
  }
}

void GroupBuilder::connect(const scene::ShaderUse& use, Range range, const std::vector<std::optional<Range>>& inputs) {
  for (std::size_t i = 0; i < use.inputs.size(); ++i) {
    if (!inputs[i]) continue;
    const scene::ShaderInput& input = use.inputs[i];
    std::string parameter;
    const lang::GroupLayer* layer = layerOf(input.parameter, range, parameter);
    const lang::GroupLayer& source = group_.layers[inputs[i]->last];
    if (parameter.empty()) parameter = closureParameter(*layer, input.location);
    if (parameter.empty()) continue;
    const std::string output = chooseOutput(input, *source.program, *layer->program, parameter);
    if (output.empty()) {
      errors_.error(input.location, fmt::format("shader '{}' has no outputs to connect", source.program->name));
      continue;
    }
    group_.connections.push_back({source.name, output, layer->name, parameter,
                                  input.output.empty() ? input.location : input.outputLocation, input.location});
  }
}

/// For a nested shader without a name: the next closure parameter.
std::string GroupBuilder::closureParameter(const lang::GroupLayer& layer, const SourceLocation& location) {
  for (const lang::Parameter& parameter : layer.program->parameters) {
    if (!parameter.type.closure || parameter.isOutput) continue;
    const bool isTaken = std::any_of(group_.connections.begin(), group_.connections.end(), [&](const auto& known) {
      return known.layer == layer.name && known.parameter == parameter.name;
    });
    if (!isTaken) return parameter.name;
  }
  errors_.error(location, "name=\"…\" is missing: the parameter that this shader feeds",
                {fmt::format("parameters of shader '{}': {}", layer.program->name,
                             lang::ParameterNames(*layer.program).list(false))});
  return {};
}

/// The output of a layer that is meant when none is named: the first of the parameter's own type, or else of its kind,
/// or else that converts; a surface or volume gives its Ci where a closure is wanted.
std::string GroupBuilder::chooseOutput(const scene::ShaderInput& input, const lang::Program& source,
                                       const lang::Program& target, const std::string& parameter) const {
  if (!input.output.empty()) return input.output;
  const auto part = lang::ParameterNames(target).find(parameter);
  const lang::Type wanted =
      part ? lang::partType(target.parameters[part->parameters[0]].type, part->element, part->component) : lang::Type{};
  const auto first = [&](auto&& fits) -> std::string {
    for (const lang::Parameter& output : source.parameters)
      if (output.isOutput && fits(output.type)) return output.name;
    return {};
  };
  std::string name = first([&](const lang::Type& type) { return type == wanted; });
  if (name.empty()) name = first([&](const lang::Type& type) { return lang::sameKind(type, wanted); });
  if (name.empty()) name = first([&](const lang::Type& type) { return lang::connects(type, wanted); });
  const bool showsCi = source.kind == "surface" || source.isVolume();
  if (name.empty() && wanted.closure && showsCi) return "Ci";
  return name.empty() ? first([](const lang::Type&) { return true; }) : name;
}

}  // namespace aerosol::render

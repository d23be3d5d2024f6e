#include "core/render/group_binding.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/lang/group_names.h"
#include "core/lang/group_text.h"

namespace aerosol::render {

namespace {

constexpr std::string_view nestedNormal = "nested_normal";
constexpr std::string_view shadingNormal = "shading_normal";

const lang::Parameter* findTriple(const lang::Program& program, std::string_view name, bool isOutput) {
  for (const lang::Parameter& parameter : program.parameters) {
    if (parameter.name == name && parameter.isOutput == isOutput && parameter.type.isTriple()) return &parameter;
  }
  return nullptr;
}

/// A text of a parameter's metadata; empty when it has none.
std::string metadataText(const lang::Parameter& parameter, std::string_view name) {
  for (const lang::MetadataValue& entry : parameter.metadata) {
    const auto* texts = std::get_if<std::vector<std::string>>(&entry.value);
    if (entry.name == name && texts && !texts->empty()) return texts->front();
  }
  return {};
}

bool hasMetadata(const lang::Parameter& parameter, std::string_view name) {
  return std::any_of(parameter.metadata.begin(), parameter.metadata.end(),
                     [&](const lang::MetadataValue& entry) { return entry.name == name; });
}

}  // namespace

Result<lang::Group> GroupBuilder::build(const scene::ShaderUse& shader) {
  const bool isGroup = shader.code && shader.code->isGroup;
  add(shader, isGroup || shader.code ? "shader" : shader.name, true, {});
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

std::optional<GroupBuilder::Range> GroupBuilder::add(const scene::ShaderUse& use, const std::string& name, bool isWhole,
                                                     const Frame& frame) {
  std::vector<std::optional<Range>> inputs(use.inputs.size());
  const auto addInputs = [&](bool materials, const Frame& around) {
    for (std::size_t i = 0; i < use.inputs.size(); ++i) {
      if (layers_[use.inputs[i].layer].isMaterial == materials) inputs[i] = addInput(use.inputs[i], around);
    }
  };
  addInputs(false, {});
  const std::optional<Frame> nested = addFrame(use, name, inputs, frame);
  if (!nested) return std::nullopt;
  addInputs(true, *nested);
  const std::size_t first = group_.layers.size();
  if (!addLayers(use, name, isWhole)) return std::nullopt;
  const Range range{first, group_.layers.size() - 1};
  setValues(use, range);
  connect(use, range, inputs);
  connectFrame(range, frame, use.origin.location);
  return range;
}

std::optional<GroupBuilder::Range> GroupBuilder::addInput(const scene::ShaderInput& input, const Frame& frame) {
  const auto key = std::pair(input.layer, frame);
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const scene::ShaderUse& layer = layers_[input.layer];
  const std::string fallback = input.parameter.empty() ? layer.name : input.parameter;
  const auto range = add(layer, layer.origin.id.empty() ? fallback : layer.origin.id, false, frame);
  known_[key] = range;
  return range;
}

/// The frame of the materials in a shader: a copy of it when it turns normals, the one around it otherwise. Nothing
/// after an error.
std::optional<GroupBuilder::Frame> GroupBuilder::addFrame(const scene::ShaderUse& use, const std::string& name,
                                                          const std::vector<std::optional<Range>>& inputs,
                                                          const Frame& outer) {
  const bool hasMaterials = std::any_of(use.inputs.begin(), use.inputs.end(), [&](const scene::ShaderInput& input) {
    return layers_[input.layer].isMaterial;
  });
  if (!hasMaterials || (use.code && use.code->isGroup)) return outer;
  const std::size_t first = group_.layers.size();
  if (!addLayers(use, name + "_normal", false)) return std::nullopt;
  if (!findTriple(*group_.layers.back().program, nestedNormal, true)) {
    group_.layers.pop_back();
    return outer;
  }
  const Range range{first, first};
  setValues(use, range);
  connect(use, range, inputs);
  connectFrame(range, outer, use.origin.location);
  if (errors_.hasErrors()) return std::nullopt;
  return group_.layers.back().name;
}

void GroupBuilder::connectFrame(Range range, const Frame& frame, const SourceLocation& location) {
  const lang::GroupLayer& layer = group_.layers[range.last];
  if (frame.empty() || !findTriple(*layer.program, shadingNormal, false)) return;
  group_.connections.push_back(
      {frame, std::string(nestedNormal), layer.name, std::string(shadingNormal), location, location});
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
    if (auto value = givenValue(*layer->program, inLayer, errors_, warnings_))
      layer->values.push_back(std::move(*value));
  }
}

void GroupBuilder::connect(const scene::ShaderUse& use, Range range, const std::vector<std::optional<Range>>& inputs) {
  for (std::size_t i = 0; i < use.inputs.size(); ++i) {
    if (!inputs[i]) continue;  // In error, or a material, which comes after the copy that gives its normal.
    const scene::ShaderInput& input = use.inputs[i];
    std::string parameter;
    const lang::GroupLayer* layer = layerOf(input.parameter, range, parameter);
    const lang::GroupLayer& source = group_.layers[inputs[i]->last];
    parameter = parameterFor(input, *layer, parameter);
    if (parameter.empty()) continue;
    const std::string output = chooseOutput(input, *source.program, *layer->program, parameter);
    if (output.empty()) {
      errors_.error(input.location, fmt::format("shader '{}' has no outputs to connect", source.program->name));
      continue;
    }
    group_.connections.push_back({source.name, output, layer->name, parameter,
                                  input.output.empty() ? input.location : input.outputLocation, input.location});
    connectFollowers(*layer, parameter, source, input.location);
  }
}

/// Parameters that take more of what feeds another one.
void GroupBuilder::connectFollowers(const lang::GroupLayer& layer, const std::string& parameter,
                                    const lang::GroupLayer& source, const SourceLocation& location) {
  for (const lang::Parameter& other : layer.program->parameters) {
    const std::string follows = metadataText(other, "follows");
    if (!follows.starts_with(parameter + ".")) continue;
    const bool isOptional = follows.ends_with('?');
    const std::string output = follows.substr(parameter.size() + 1, follows.size() - parameter.size() - 1 - isOptional);
    const lang::ParameterNames names(*source.program);
    const auto index = names.findLeaf(output);
    if (!index || !source.program->parameters[*index].isOutput) {
      if (isOptional) continue;
      errors_.error(location, fmt::format("shader '{}' has no output '{}', which '{}' of shader '{}' needs",
                                          source.program->name, output, other.name, layer.program->name));
      continue;
    }
    group_.connections.push_back({source.name, output, layer.name, other.name, location, location});
  }
}

/// The parameter that an input feeds: the one it names; a material whose name is none feeds the next closure, any other
/// shader the parameter that takes any name.
std::string GroupBuilder::parameterFor(const scene::ShaderInput& input, const lang::GroupLayer& layer,
                                       const std::string& named) {
  if (!named.empty() && lang::ParameterNames(*layer.program).find(named)) return named;
  if (layers_[input.layer].isMaterial || named.empty()) {
    const auto& all = layer.program->parameters;
    const bool takesMaterials = std::any_of(all.begin(), all.end(), [](const lang::Parameter& parameter) {
      return parameter.type.closure && !parameter.isOutput;
    });
    if (layers_[input.layer].isMaterial && takesMaterials) return closureParameter(layer, input.location);
  }
  if (!layers_[input.layer].isMaterial) {
    for (const lang::Parameter& parameter : layer.program->parameters) {
      if (hasMetadata(parameter, "any_name")) return parameter.name;
    }
  }
  return named.empty() ? closureParameter(layer, input.location) : named;
}

/// For a nested shader without a name: the next closure parameter.
std::string GroupBuilder::closureParameter(const lang::GroupLayer& layer, const SourceLocation& location) {
  int taken = 0;
  for (const lang::Parameter& parameter : layer.program->parameters) {
    if (!parameter.type.closure || parameter.isOutput) continue;
    const bool isTaken = std::any_of(group_.connections.begin(), group_.connections.end(), [&](const auto& known) {
      return known.layer == layer.name && known.parameter == parameter.name;
    });
    if (!isTaken) return parameter.name;
    ++taken;
  }
  if (taken > 0) {
    errors_.error(location, fmt::format("shader '{}' takes no more than {} nested material{}", layer.program->name,
                                        taken, taken == 1 ? "" : "s"));
    return {};
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
  const bool showsCi = source.isSurface() || source.isVolume();
  if (name.empty() && wanted.closure && showsCi) return "Ci";
  return name.empty() ? first([](const lang::Type&) { return true; }) : name;
}

}  // namespace aerosol::render

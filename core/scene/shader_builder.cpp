#include "core/scene/shader_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/scene/property_reader.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

namespace {

/// What may stand in a shader element as a layer.
std::vector<std::string> nestedTags(const std::string& tag) {
  if (tag == "medium") return {"texture", "medium", "volume", "phase"};
  if (tag == "texture" || tag == "volume") return {"texture", "volume"};
  return tag == "bsdf" ? std::vector<std::string>{"texture", "bsdf"} : std::vector<std::string>{"texture"};
}

}  // namespace

ShaderUse ShaderBuilder::shaderOf(const Element& element, const std::vector<const Property*>& properties) {
  ShaderUse shader;
  shader.name = element.type;
  shader.nameLocation = element.typeLocation;
  shader.isMaterial = element.tag == "bsdf";
  shader.origin.id = element.id;
  shader.origin.location = element.location;
  for (const Property* property : properties) {
    if (!property->value) continue;
    if (!property->keys.empty()) {
      reporter_.error(property->location,
                      fmt::format("'{}' of a shader cannot be animated: give it one transform", property->name));
      continue;
    }
    shader.parameters.push_back({property->name, *property->value, property->nameLocation, property->valueLocation});
    shader.origin.parameters[property->name] = property->valueLocation;
  }
  if (element.code) {
    const Code& code = *element.code;
    shader.code = {code.tag == "group", code.text, {}, code.location};
    if (code.tag == "source" && code.file) shader.code->file = *code.file;
  }
  if (element.code.has_value() != (element.type == "osl")) {
    reporter_.error(element.typeLocation,
                    element.code ? fmt::format("a {} with <{}> is of type osl", element.tag, element.code->tag)
                                 : fmt::format("a {} of type osl needs its <source> or <group>", element.tag));
  }
  return shader;
}

void ShaderBuilder::addInputs(const std::vector<Child>& children, ShaderUse& shader) {
  for (const Child& child : children) {
    if (child.object->tag == "phase") continue;
    const std::optional<Index> index = layer(child);
    if (!index) continue;
    const std::string& name = child.use->name;
    const ShaderParameter* written = name.empty() ? nullptr : shader.find(name);
    const auto same = std::find_if(shader.inputs.begin(), shader.inputs.end(),
                                   [&](const ShaderInput& input) { return !name.empty() && input.parameter == name; });
    const SourceLocation& place = name.empty() ? child.use->location : child.use->nameLocation;
    if (written || same != shader.inputs.end()) {
      reporter_.error(place, fmt::format("parameter '{}' is given twice", name),
                      {fmt::format("the first one is at {}", format(written ? written->location : same->location))});
      continue;
    }
    if (!name.empty()) shader.origin.parameters[name] = place;
    shader.inputs.push_back({name, child.use->output, *index, place, child.use->outputLocation});
  }
}

/// Layers are shared by all that refer to them; they cannot be connected in circles.
std::optional<Index> ShaderBuilder::layer(const Child& child) {
  const Element* element = child.object;
  if (std::find(open_.begin(), open_.end(), element) != open_.end()) {
    reporter_.error(child.use->idLocation, fmt::format("'{}' is connected to itself", child.use->id));
    return std::nullopt;
  }
  if (const auto known = layers_.find(element); known != layers_.end()) return known->second;
  open_.push_back(element);
  std::vector<const Property*> properties;
  for (const Property& property : element->properties) properties.push_back(&property);
  ShaderUse shader = shaderOf(*element, properties);
  addInputs(ids_.children(*element, nestedTags(element->tag), reporter_), shader);
  open_.pop_back();
  scene_.layers.push_back(std::move(shader));
  return layers_[element] = scene_.layers.size() - 1;
}

Index ShaderBuilder::material(const Element& element) {
  const auto [entry, isNew] = materials_.try_emplace(&element, scene_.materials.size());
  if (!isNew) return entry->second;
  std::vector<const Property*> properties;
  for (const Property& property : element.properties) properties.push_back(&property);
  const Index index = entry->second;
  scene_.materials.push_back(shaderOf(element, properties));
  addLayers(element, ids_.children(element, nestedTags(element.tag), reporter_), scene_.materials[index]);
  return index;
}

std::optional<Index> ShaderBuilder::lightTexture(const Child& texture) {
  const std::optional<Index> source = layer(texture);
  if (!source) return std::nullopt;
  ShaderUse shader;
  shader.name = "light_texture";
  shader.nameLocation = texture.use->location;
  shader.origin.location = texture.use->location;
  shader.inputs.push_back(
      {"texture_color", texture.use->output, *source, texture.use->location, texture.use->outputLocation});
  scene_.materials.push_back(std::move(shader));
  return scene_.materials.size() - 1;
}

template <class T>
ShaderUse ShaderBuilder::shaderWith(const Element& element, const std::vector<Field<T>>& fields, T& object) {
  Origin origin;
  PropertyReader reader(element, origin, reporter_);
  reader.apply(fields, object);
  ShaderUse shader = shaderOf(element, reader.rest());
  shader.origin.parameters.merge(origin.parameters);
  return shader;
}

void ShaderBuilder::addLayers(const Element& element, const std::vector<Child>& children, ShaderUse& shader) {
  open_.push_back(&element);
  addInputs(children, shader);
  open_.pop_back();
}

Index ShaderBuilder::medium(const Element& element) {
  const auto [entry, isNew] = media_.try_emplace(&element, scene_.media.size());
  if (!isNew) return entry->second;
  Medium medium;
  medium.shader = shaderWith(element, samplingFields(), medium.sampling);
  const std::vector<Child> children = ids_.children(element, nestedTags(element.tag), reporter_);
  addPhase(children, medium);
  addLayers(element, children, medium.shader);
  scene_.media.push_back(std::move(medium));
  return entry->second;
}

Index ShaderBuilder::displacement(const Element& element) {
  const auto [entry, isNew] = displacements_.try_emplace(&element, scene_.displacements.size());
  if (!isNew) return entry->second;
  Displacement displacement;
  displacement.shader = shaderWith(element, tessellationFields(), displacement.tessellation);
  std::string given;
  for (const Field<Tessellation>& field : tessellationFields()) {
    if (!displacement.shader.origin.has(field.spec.name)) continue;
    if (!given.empty()) {
      reporter_.error(
          displacement.shader.origin.of(field.spec.name),
          fmt::format("'{}' and '{}' both say how fine the surface is: write one of them", given, field.spec.name));
    }
    given = field.spec.name;
  }
  addLayers(element, ids_.children(element, nestedTags(element.tag), reporter_), displacement.shader);
  scene_.displacements.push_back(std::move(displacement));
  return entry->second;
}

/// A texture for the weight of a blend: the medium's shader will give it. False when there can be none, which is
/// reported.
bool ShaderBuilder::takeWeight(const Element& blend, std::vector<Child>& children, Phase& phase) {
  const auto isPhase = [](const Child& child) { return child.object->tag == "phase"; };
  for (const Child& child : children) {
    if (isPhase(child)) continue;
    const bool isInner = !open_.empty() && open_.back()->tag == "phase";
    if (child.use->name != "weight" || phaseWeight_ || isInner || phase.origin.has("weight")) {
      reporter_.error(child.use->location,
                      child.use->name != "weight" ? fmt::format("a blendphase has no texture '{}'", child.use->name)
                      : isInner                   ? "the weight of a blendphase inside of another one is a number"
                                                  : "the weight is given twice",
                      {"a texture or a volume may be the weight of the outer one, by the name \"weight\""});
      return false;
    }
    phaseWeight_ = child;
    phase.isWeightFed = true;
  }
  std::erase_if(children, [&](const Child& child) { return !isPhase(child); });
  if (children.size() == 2) return true;
  reporter_.error(blend.location, fmt::format("a blendphase has two phases, this one has {}", children.size()));
  return false;
}

/// A phase function with its parts. None where something is wrong, which is reported.
std::optional<Phase> ShaderBuilder::readPhase(const Element& element) {
  if (std::find(open_.begin(), open_.end(), &element) != open_.end()) {
    reporter_.error(element.location, fmt::format("phase '{}' is a part of itself", element.id));
    return std::nullopt;
  }
  Phase phase;
  const TypeTable<Phase>* type = readTyped(element, phaseTypes(), phase, reporter_);
  if (type) phase.type = static_cast<PhaseType>(type - phaseTypes().data());
  const bool isBlend = type && phase.type == PhaseType::blendphase;
  const auto tags = isBlend ? std::vector<std::string>{"phase", "texture", "volume"} : std::vector<std::string>{};
  std::vector<Child> children = ids_.children(element, tags, reporter_);
  if (!type) return std::nullopt;
  if (!isBlend) return phase;
  if (!takeWeight(element, children, phase)) return std::nullopt;
  if (children[1].use->name < children[0].use->name && !children[1].use->name.empty())
    std::swap(children[0], children[1]);
  open_.push_back(&element);
  for (const Child& child : children) {
    if (auto part = readPhase(*child.object)) phase.parts.push_back(std::move(*part));
  }
  open_.pop_back();
  return phase.parts.size() == 2 ? std::optional(std::move(phase)) : std::nullopt;
}

/// A weight that varies comes from the shader, through the parameter that a mixture of fixed parts has no use for.
void ShaderBuilder::feedWeight(const Child& weight, ShaderUse& shader) {
  const SourceLocation& place = weight.use->nameLocation;
  if (shader.find("g")) {
    reporter_.error(place, "the medium gives its 'g', and a blendphase takes it for its weight",
                    {fmt::format("remove the one at {}", format(shader.find("g")->location))});
    return;
  }
  const std::optional<Index> source = layer(weight);
  if (!source) return;
  shader.origin.parameters["g"] = place;
  shader.inputs.push_back({"g", weight.use->output, *source, place, weight.use->outputLocation});
}

/// Mitsuba writes the phase function as an object of its own. A Henyey-Greenstein one is what media's shaders have, so
/// it becomes their parameter `g`; others take the place of what the shader says.
void ShaderBuilder::addPhase(const std::vector<Child>& children, Medium& medium) {
  const Child child = IdTable::single(children, "phase", reporter_);
  if (!child.object) return;
  phaseWeight_.reset();
  std::optional<Phase> phase = readPhase(*child.object);
  if (!phase) return;
  if (phaseWeight_) feedWeight(*phaseWeight_, medium.shader);
  if (phase->type != PhaseType::hg && phase->type != PhaseType::isotropic) {
    medium.phase = std::move(*phase);
    return;
  }
  ShaderUse& shader = medium.shader;
  const SourceLocation& place = phase->origin.of("g");
  if (const ShaderParameter* own = shader.find("g")) {
    reporter_.error(own->location, "parameter 'g' is given twice",
                    {fmt::format("the phase function at {} gives it too", format(child.use->location))});
    return;
  }
  shader.origin.parameters["g"] = place;
  shader.parameters.push_back({"g", phase->g, place, place});
}

Index ShaderBuilder::defaultMaterial(const SourceLocation& shape, bool emits) {
  std::optional<Index>& index = emits ? black_ : grey_;
  if (index) return *index;
  index = scene_.materials.size();
  ShaderUse shader;
  shader.name = "diffuse";
  shader.nameLocation = shape;
  shader.origin.location = shape;
  if (emits) shader.parameters.push_back({"reflectance", Color(0), shape, shape});
  scene_.materials.push_back(std::move(shader));
  return *index;
}

}  // namespace aerosol::scene

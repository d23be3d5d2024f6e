#include "core/scene/shader_builder.h"

#include <fmt/format.h>

#include <utility>

#include "core/scene/property_reader.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

ShaderUse ShaderBuilder::shaderOf(const Element& element, const std::vector<const Property*>& properties) const {
  ShaderUse shader;
  shader.name = element.type;
  shader.nameLocation = element.typeLocation;
  shader.origin.id = element.id;
  shader.origin.location = element.location;
  for (const Property* property : properties) {
    if (!property->value) continue;
    shader.parameters.push_back({property->name, *property->value, property->nameLocation, property->valueLocation});
    shader.origin.parameters[property->name] = property->valueLocation;
  }
  return shader;
}

Index ShaderBuilder::material(const Element& element) {
  const auto [entry, isNew] = materials_.try_emplace(&element, scene_.materials.size());
  if (!isNew) return entry->second;
  std::vector<const Property*> properties;
  for (const Property& property : element.properties) properties.push_back(&property);
  ids_.children(element, {}, reporter_);
  scene_.materials.push_back(shaderOf(element, properties));
  return entry->second;
}

Index ShaderBuilder::medium(const Element& element) {
  const auto [entry, isNew] = media_.try_emplace(&element, scene_.media.size());
  if (!isNew) return entry->second;
  Medium medium;
  Origin origin;
  PropertyReader reader(element, origin, reporter_);
  reader.apply(samplingFields(), medium.sampling);
  medium.shader = shaderOf(element, reader.rest());
  medium.shader.origin.parameters.merge(origin.parameters);
  addPhase(element, medium.shader);
  scene_.media.push_back(std::move(medium));
  return entry->second;
}

/// Mitsuba writes the phase function as an object of its own; here it is part of the medium's shader, which gets the
/// object's parameter `g` as its own.
void ShaderBuilder::addPhase(const Element& medium, ShaderUse& shader) {
  const Child phase = IdTable::single(ids_.children(medium, {"phase"}, reporter_), "phase", reporter_);
  if (!phase.object) return;
  PhaseFunction function;
  const TypeTable<PhaseFunction>* type = readTyped(*phase.object, phaseTypes(), function, reporter_);
  ids_.children(*phase.object, {}, reporter_);
  if (!type) return;
  const SourceLocation& place = function.origin.of("g");
  if (const ShaderParameter* own = shader.find("g")) {
    reporter_.error(own->location, "parameter 'g' is given twice",
                    {fmt::format("the phase function at {} gives it too", format(phase.use->location))});
    return;
  }
  shader.origin.parameters["g"] = place;
  shader.parameters.push_back({"g", function.g, place, place});
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

#include "core/scene/property_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace aerosol::scene {

namespace {

std::string withArticle(std::string_view word) {
  return fmt::format("{} {}", word == "integer" || word == "rgb" ? "an" : "a", word);
}

}  // namespace

std::string describe(const Element& element) { return fmt::format("{} '{}'", element.tag, element.type); }

std::string wrongType(const ParameterSpec& spec, std::string_view given) {
  return fmt::format("parameter '{}' is {}, not {}", spec.name, withArticle(name(spec.type)), withArticle(given));
}

void reportUnknownType(const Element& element, const std::vector<std::string>& types, Reporter& reporter) {
  if (element.type.empty()) return;
  reporter.error(element.typeLocation, fmt::format("unknown {} type '{}'", element.tag, element.type),
                 alternatives(element.type, types, "known types:"));
}

PropertyReader::PropertyReader(const Element& element, Origin& origin, Reporter& reporter)
    : element_(element), origin_(origin), reporter_(reporter) {
  origin_.id = element.id;
  origin_.location = element.location;
  for (const Property& property : element.properties) open_.push_back(&property);
}

PropertyReader::Taken PropertyReader::take(const ParameterSpec& spec) {
  known_.push_back(spec.name);
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const Property* p) { return p->name == spec.name; });
  if (found == open_.end()) {
    if (spec.required) {
      reporter_.error(element_.location, fmt::format("{} lacks its parameter '{}' ({}: {})", describe(element_),
                                                     spec.name, name(spec.type), spec.doc));
    }
    return {};
  }
  const Property* property = *found;
  open_.erase(found);
  origin_.parameters[spec.name] = property->valueLocation;
  if (!property->value) return {};
  std::optional<Value> value = convert(*property->value, spec.type);
  if (!value) {
    reporter_.error(property->location, wrongType(spec, property->tag));
    return {};
  }
  if (const std::string problem = checkValue(spec, *value); !problem.empty()) {
    std::vector<std::string> notes;
    if (const auto* text = std::get_if<std::string>(&*value)) {
      if (std::string near = didYouMean(text->substr(0, 64), spec.choices); !near.empty()) notes.push_back(near);
    }
    reporter_.error(property->valueLocation, problem, std::move(notes));
    return {};
  }
  if (spec.withoutEffect) {
    reporter_.warning(property->nameLocation, fmt::format("parameter '{}' has no effect here", spec.name),
                      {"it is read so that scenes of other renderers open: remove it, or leave it"});
  }
  return {property, std::move(value)};
}

bool PropertyReader::refuseMotion(const Property& property) const {
  reporter_.error(property.location, fmt::format("'{}' of {} cannot be animated: give it one transform", property.name,
                                                 describe(element_)));
  return false;
}

void PropertyReader::apply(const std::vector<ParameterSpec>& specs, std::vector<NamedValue>& values) {
  for (const ParameterSpec& spec : specs) {
    Taken taken = take(spec);
    if (taken.property && !taken.property->keys.empty()) refuseMotion(*taken.property);
    if (taken.value)
      values.push_back({spec.name, std::move(*taken.value)});
    else if (spec.defaultValue)
      values.push_back({spec.name, *spec.defaultValue});
  }
}

void PropertyReader::applyAttributes(std::vector<NamedValue>& attributes) {
  std::erase_if(open_, [&](const Property* property) {
    if (!property->name.starts_with("user:")) return false;
    if (!property->keys.empty()) refuseMotion(*property);
    if (property->value) attributes.push_back({property->name, *property->value});
    return true;
  });
}

std::vector<const Property*> PropertyReader::rest() const { return open_; }

void PropertyReader::finish() {
  for (const Property* property : open_) {
    reporter_.error(property->nameLocation, fmt::format("{} has no parameter '{}'", describe(element_), property->name),
                    alternatives(property->name, known_, "its parameters:"));
  }
}

}  // namespace aerosol::scene

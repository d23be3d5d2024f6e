#include "core/scene/parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/scene/reporter.h"

namespace aerosol::scene {

std::string format(const Range& range) {
  const bool below = range.minimum > -std::numeric_limits<double>::infinity();
  const bool above = range.maximum < std::numeric_limits<double>::infinity();
  if (below && above && range.openMinimum && range.openMaximum) {
    return fmt::format("between {} and {}, both excluded", range.minimum, range.maximum);
  }
  if (below && above && !range.openMinimum && !range.openMaximum) {
    return fmt::format("{} to {}", range.minimum, range.maximum);
  }
  std::vector<std::string> parts;
  if (below) parts.push_back(fmt::format("{} {}", range.openMinimum ? ">" : "at least", range.minimum));
  if (above) parts.push_back(fmt::format("{} {}", range.openMaximum ? "<" : "at most", range.maximum));
  return fmt::format("{}", fmt::join(parts, " and "));
}

namespace {

/// Of places and sizes squares have to fit into floats. (Distances at which something ends may be endless.)
std::string checkSize(const ParameterSpec& spec, const Value& value) {
  if (spec.unit != "scene units") return {};
  std::vector<float> numbers;
  if (const auto* p = std::get_if<Point<Unplaced>>(&value)) numbers = {p->x, p->y, p->z};
  const auto* const number = std::get_if<float>(&value);
  const bool isRadius = number && spec.name.ends_with("radius");
  if (isRadius) numbers = {*number};
  for (const float x : numbers) {
    if (std::fabs(x) > 1e18f)
      return fmt::format("'{}' is {}, beyond 1e18 scene units: write lengths in a larger unit", spec.name,
                         format(value));
  }
  if (isRadius && *number > 0 && *number < 1e-18f)
    return fmt::format("'{}' is {}, below 1e-18 scene units: write lengths in a smaller unit", spec.name,
                       format(value));
  return {};
}

}  // namespace

std::string checkValue(const ParameterSpec& spec, const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (spec.choices.empty() || std::find(spec.choices.begin(), spec.choices.end(), *text) != spec.choices.end()) {
      return {};
    }
    return fmt::format("'{}' is '{}', it has to be {}", spec.name, *text, joinWithOr(spec.choices));
  }
  std::vector<double> numbers;
  if (const auto* v = std::get_if<int>(&value)) numbers = {static_cast<double>(*v)};
  if (const auto* v = std::get_if<float>(&value)) numbers = {static_cast<double>(*v)};
  if (const auto* v = std::get_if<Color>(&value)) {
    numbers = {static_cast<double>(v->r), static_cast<double>(v->g), static_cast<double>(v->b)};
  }
  for (const double number : numbers) {
    if (spec.range.contains(number)) continue;
    return fmt::format("'{}' is {}, it has to be {}", spec.name, format(value), format(spec.range));
  }
  return checkSize(spec, value);
}

std::vector<VolumeType> defaultVolumeTypes() {
  return {{.type = "sphere",
           .doc = "a ball filled with a medium",
           .parameters = {{.name = "center",
                           .type = ValueType::point,
                           .unit = "scene units",
                           .doc = "centre, in the primitive's own space",
                           .defaultValue = Point<Unplaced>(0, 0, 0)},
                          {.name = "radius",
                           .type = ValueType::number,
                           .unit = "scene units",
                           .doc = "radius, in the primitive's own space",
                           .defaultValue = 1.0f,
                           .range = Range::positive()}}},
          {.type = "box", .doc = "a box from -1 to 1 on each axis of its own space, filled with a medium"}};
}

const VolumeType* KnownTypes::volume(const std::string& type) const {
  for (const VolumeType& known : volumes) {
    if (known.type == type) return &known;
  }
  return nullptr;
}

}  // namespace aerosol::scene

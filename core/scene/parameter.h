// What a parameter of a scene object is: its name, type, unit, default, range and meaning.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/value.h"

namespace aerosol::scene {

/// An interval of numbers; an open end does not belong to it.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool openMinimum = false;
  bool openMaximum = false;

  static Range positive() { return {.minimum = 0, .openMinimum = true}; }
  static Range atLeast(double minimum) { return {.minimum = minimum}; }

  bool contains(double v) const {
    return (openMinimum ? v > minimum : v >= minimum) && (openMaximum ? v < maximum : v <= maximum);
  }
};

/// "> 0", "0 to 1", "at least 1", "between 0 and 180, both excluded"; empty for all numbers.
std::string format(const Range& range);

/// One parameter, for checks and for its documentation.
struct ParameterSpec {
  std::string name = {};
  ValueType type = ValueType::number;
  std::string unit = {};                   ///< "scene units", "degrees" …; empty when there is none.
  std::string doc = {};                    ///< One sentence, without a full stop.
  std::optional<Value> defaultValue = {};  ///< None: nothing happens unless it is written.
  std::string defaultText = {};            ///< Shown instead of the default value.
  bool required = false;
  Range range = {};                       ///< Of numbers, and of each channel of a colour.
  std::vector<std::string> choices = {};  ///< Of a string; empty when any text will do.
  bool withoutEffect = false;             ///< Known from other renderers, has no meaning here: a warning says so.
};

/// Why `value`, which has the type of `spec`, is not allowed; empty when it is.
std::string checkValue(const ParameterSpec& spec, const Value& value);

/// One volume primitive's type: a plugin's name, what it is, and its own parameters.
struct VolumeType {
  std::string type = {};
  std::string doc = {};
  std::vector<ParameterSpec> parameters = {};
};

/// `sphere` (center, radius) and `box` (from -1 to 1 on each axis of its own space).
std::vector<VolumeType> defaultVolumeTypes();

/// The object types that plugins add to the scene format.
struct KnownTypes {
  std::vector<VolumeType> volumes = defaultVolumeTypes();

  /// Null when unknown.
  const VolumeType* volume(const std::string& type) const;
};

}  // namespace aerosol::scene

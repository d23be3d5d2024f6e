// What a parameter of a feature is: name, unit, range, meaning. Written once beside the feature.
#pragma once

#include <span>
#include <string_view>

namespace aerosol {

enum class FieldType : unsigned char {
  number,     ///< One float.
  direction,  ///< Three: a unit vector in world space.
  color,      ///< Three.
  choice      ///< One: the index of a text among `choices`.
};

/// One parameter that is given as floats.
struct DescribedField {
  std::string_view name;
  FieldType type = FieldType::number;
  std::string_view unit;  ///< Empty when there is none.
  float minimum = 0;      ///< Of a number.
  float maximum = 1;
  std::string_view doc;                            ///< One sentence, without a full stop.
  float defaultValue = 0;                          ///< Of each component, where a caller may leave it out.
  std::span<const std::string_view> choices = {};  ///< The first one serves for any other text.

  constexpr int components() const { return type == FieldType::direction || type == FieldType::color ? 3 : 1; }
};

/// How many floats the parameters take together.
constexpr int componentCount(std::span<const DescribedField> fields) {
  int count = 0;
  for (const DescribedField& field : fields) count += field.components();
  return count;
}

}  // namespace aerosol

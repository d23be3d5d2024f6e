// What a parameter of a feature is: name, unit, range, meaning. Written once beside the feature.
#pragma once

#include <span>
#include <string_view>

namespace aerosol {

enum class FieldType : unsigned char { number, direction };

/// One parameter that is given as floats: a number, or a unit vector in world space as three.
struct DescribedField {
  std::string_view name;
  FieldType type = FieldType::number;
  std::string_view unit;  ///< Empty when there is none.
  float minimum = 0;      ///< Of a number.
  float maximum = 1;
  std::string_view doc;  ///< One sentence, without a full stop.

  constexpr int components() const { return type == FieldType::direction ? 3 : 1; }
};

/// How many floats the parameters take together.
constexpr int componentCount(std::span<const DescribedField> fields) {
  int count = 0;
  for (const DescribedField& field : fields) count += field.components();
  return count;
}

}  // namespace aerosol

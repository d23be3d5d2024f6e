// The types of Open Shading Language.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace aerosol::lang {

enum class BaseType : std::uint8_t {
  none,  ///< void
  integer,
  floating,
  string,
  color,
  point,
  vector,
  normal,
  matrix,
  structure,
};

struct StructType;

/// A type: a base type (or `closure color`), possibly an array of it.
struct Type {
  static constexpr int scalar = 0;    ///< `arrayLength` of what is no array.
  static constexpr int unsized = -1;  ///< `arrayLength` of `float x[]`.

  BaseType base = BaseType::none;
  bool closure = false;  ///< `closure color`; base is `color` then.
  int arrayLength = scalar;
  const StructType* structure = nullptr;  ///< Set when base is `structure`; owned by the compilation.

  bool isArray() const { return arrayLength != scalar; }
  bool isTriple() const {
    return !closure &&
           (base == BaseType::color || base == BaseType::point || base == BaseType::vector || base == BaseType::normal);
  }
  /// Int or float, no array.
  bool isNumber() const { return !isArray() && (base == BaseType::integer || base == BaseType::floating); }
  Type element() const { return {base, closure, scalar, structure}; }
  Type arrayOf(int length) const { return {base, closure, length, structure}; }
  bool operator==(const Type&) const = default;
};

struct StructField {
  std::string name;
  Type type;
};

struct StructType {
  std::string name;
  std::vector<StructField> fields;
};

/// As written in source: `float`, `closure color`, `point[3]`, `MyStruct`.
std::string toString(const Type& type);

namespace types {
inline constexpr Type none{};
inline constexpr Type integer{BaseType::integer};
inline constexpr Type floating{BaseType::floating};
inline constexpr Type string{BaseType::string};
inline constexpr Type color{BaseType::color};
inline constexpr Type point{BaseType::point};
inline constexpr Type vector{BaseType::vector};
inline constexpr Type normal{BaseType::normal};
inline constexpr Type matrix{BaseType::matrix};
inline constexpr Type closure{BaseType::color, true};
}  // namespace types

}  // namespace aerosol::lang

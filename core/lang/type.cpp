#include "core/lang/type.h"

namespace aerosol::lang {

namespace {

std::string baseName(const Type& type) {
  switch (type.base) {
    case BaseType::none:
      return "void";
    case BaseType::integer:
      return "int";
    case BaseType::floating:
      return "float";
    case BaseType::string:
      return "string";
    case BaseType::color:
      return type.closure ? "closure color" : "color";
    case BaseType::point:
      return "point";
    case BaseType::vector:
      return "vector";
    case BaseType::normal:
      return "normal";
    case BaseType::matrix:
      return "matrix";
    case BaseType::structure:
      return type.structure ? type.structure->name : "struct";
  }
  return "void";
}

}  // namespace

std::string toString(const Type& type) {
  std::string text = baseName(type);
  if (type.arrayLength == Type::unsized) return text + "[]";
  if (type.isArray()) return text + "[" + std::to_string(type.arrayLength) + "]";
  return text;
}

}  // namespace aerosol::lang

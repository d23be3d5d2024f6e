#include "core/lang/overload.h"

namespace aerosol::lang {

namespace {

bool isSpatial(const Type& type) { return type.isTriple() && type.base != BaseType::color; }

bool isAssignableElement(const Type& to, const Type& from) {
  if (to == from) return true;
  if (to.closure || from.closure) return false;
  if (to.isTriple() && from.isTriple()) return true;
  if (!from.isNumber()) return false;
  return to.base == BaseType::floating || to.isTriple() || to.base == BaseType::matrix;
}

}  // namespace

bool isAssignable(const Type& to, const Type& from) {
  if (to == from) return true;
  if (to.isArray() != from.isArray()) return false;
  if (!to.isArray()) return isAssignableElement(to, from);
  const Type toElement = to.element(), fromElement = from.element();
  const bool sameElement = toElement == fromElement || (toElement.isTriple() && fromElement.isTriple());
  const bool fits =
      to.arrayLength == Type::unsized || from.arrayLength == Type::unsized || to.arrayLength >= from.arrayLength;
  return sameElement && fits;
}

bool isConditional(const Type& type) {
  return !type.isArray() && type.base != BaseType::none && type.base != BaseType::structure;
}

int matchScore(const Type& formal, const Type& actual) {
  if (formal == actual) return 100;
  if (formal.isNumber() && actual.isNumber()) return formal.base == BaseType::floating ? 77 : 0;
  if (formal.arrayLength == Type::unsized && actual.isArray() && formal.element() == actual.element()) return 44;
  if (!isAssignable(formal, actual)) return 0;
  if (isSpatial(formal) && isSpatial(actual)) return 32;
  if (formal.isTriple() && actual.isTriple()) return 27;
  return 23;
}

int resultRank(const Type& type) {
  if (type.closure) return 8;
  switch (type.base) {
    case BaseType::floating:
      return 0;
    case BaseType::integer:
      return 1;
    case BaseType::color:
      return 2;
    case BaseType::vector:
      return 3;
    case BaseType::point:
      return 4;
    case BaseType::normal:
      return 5;
    case BaseType::matrix:
      return 6;
    case BaseType::string:
      return 7;
    case BaseType::structure:
      return 9;
    case BaseType::none:
      return 10;
  }
  return 11;
}

}  // namespace aerosol::lang

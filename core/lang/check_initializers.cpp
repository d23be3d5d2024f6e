// What may become the value of what: assignments, initial values, lists in braces.
#include <algorithm>

#include "core/lang/checker.h"
#include "core/lang/overload.h"

namespace aerosol::lang {

bool isZeroLiteral(const Expression& expression) {
  if (const auto* literal = std::get_if<IntLiteral>(&expression.node)) return literal->value == 0;
  if (const auto* literal = std::get_if<FloatLiteral>(&expression.node)) return literal->value == 0;
  return false;
}

void Checker::warnOfTruncation(Position position, std::string_view what) {
  warning(position, std::string(what) + " is of type float, which is truncated to int",
          {"write (int) in front to say so"});
}

void Checker::requireAssignable(const Type& to, const Expression& from, std::string_view what, Truncation truncation) {
  if (isPoisoned(to) || isPoisoned(from.type) || isAssignable(to, from.type)) return;
  const bool truncates = to == types::integer && from.type == types::floating;
  if (truncates && truncation == Truncation::warned) return warnOfTruncation(from.position, what);
  if (to == types::closure && isZeroLiteral(from)) return;
  std::vector<std::string> notes;
  if (truncates) notes.emplace_back("write (int) in front to truncate it");
  if (to.isArray() && from.type.isArray() && to.element() == from.type.element())
    notes.emplace_back("the array on the left must be at least as long");
  error(from.position,
        std::string(what) + " is of type " + toString(from.type) + ", which does not convert to " + toString(to),
        std::move(notes));
}

Type Checker::checkInitializer(Expression& expression, const Type& target, std::string_view what,
                               Truncation truncation) {
  if (isPoisoned(target)) {
    if (!std::holds_alternative<InitializerList>(expression.node)) check(expression, types::none);
    return target;
  }
  if (auto* list = std::get_if<InitializerList>(&expression.node)) {
    expression.type = checkInitializerList(expression, *list, target);
    return isPoisoned(expression.type) ? target : expression.type;
  }
  const Type type = check(expression, target);
  if (type == types::none) {
    error(expression.position, std::string(what) + " is void: there is no value");
    return target;
  }
  requireAssignable(target, expression, what, truncation);
  if (target.arrayLength == Type::unsized && type.isArray()) return target.arrayOf(type.arrayLength);
  return target;
}

Type Checker::checkInitializerList(Expression& expression, InitializerList& list, const Type& target) {
  const auto count = static_cast<int>(list.elements.size());
  const auto tooMany = [&](int wanted, std::size_t at) {
    const Position position = at < list.elements.size() ? list.elements[at]->position : expression.position;
    error(position, "too many values for " + toString(target) + ": " + std::to_string(count) + " instead of " +
                        std::to_string(wanted));
    return poisoned;
  };
  if (target.isArray()) {
    if (target.arrayLength >= 0 && count > target.arrayLength)
      return tooMany(target.arrayLength, static_cast<std::size_t>(target.arrayLength));
    if (count > maximumArrayLength) return tooMany(maximumArrayLength, 0);
    for (const ExpressionPtr& element : list.elements)
      checkInitializer(*element, target.element(), "an element of the array");
    // Without values, and where nothing else gives some: one element, which is zero.
    return target.arrayLength == Type::unsized ? target.arrayOf(std::max(count, 1)) : target;
  }
  if (target.base == BaseType::structure) {
    const auto& fields = target.structure->fields;
    if (list.elements.size() > fields.size()) return tooMany(static_cast<int>(fields.size()), fields.size());
    for (std::size_t i = 0; i < list.elements.size(); ++i)  // Fields after them are zero.
      checkInitializer(*list.elements[i], fields[i].type, "the value of field '" + fields[i].name + "'");
    return target;
  }
  const int components = target.isTriple() ? 3 : target == types::matrix ? 16 : 1;
  if (count != components && count > 1) {
    error(expression.position, toString(target) + " takes " + std::to_string(components) +
                                   (components == 1 ? " value" : " values") + ", not " + std::to_string(count));
    return poisoned;
  }
  const Type each = count == 1 && components == 1 ? target : types::floating;
  for (const ExpressionPtr& element : list.elements) checkInitializer(*element, each, "the value");
  return target;
}

}  // namespace aerosol::lang

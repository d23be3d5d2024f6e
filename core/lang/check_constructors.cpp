#include <algorithm>
#include <array>

#include "core/lang/checker.h"
#include "core/lang/overload.h"

namespace aerosol::lang {

namespace {

constexpr std::array<std::string_view, 11> colorSpaces = {"rgb", "RGB", "linear", "Rec709", "HDTV", "sRGB",
                                                          "hsv", "hsl", "YIQ",    "XYZ",    "xyY"};

}  // namespace

Type Checker::checkConstruct(Expression& expression, Construct& construct, const Type&) {
  if (construct.type.base == BaseType::structure) {
    const StructType* structure = findStruct(construct.type.structName, expression.position);
    if (!structure) return resolveType(construct.type, Type::scalar, nullptr);
    return checkStructConstructor(expression, construct.arguments, *structure, expression.position);
  }
  const Type type{construct.type.base, construct.type.closure, Type::scalar, nullptr};
  if (construct.arguments.empty()) {
    error(expression.position, toString(type) + "() needs a value");
    return poisoned;
  }
  if (strict_ && type == types::string && !construct.isCast) {
    for (const ExpressionPtr& argument : construct.arguments) check(*argument, types::none);
    error(expression.position, "strings have no constructor", {"format(\"%g\", value) makes one of a number"});
    return poisoned;
  }
  if (construct.isCast || construct.arguments.size() == 1) return checkCast(expression, construct, type);
  if (type.isTriple()) return checkTriple(expression, construct, type);
  if (type == types::matrix) return checkMatrix(expression, construct);
  error(expression.position, toString(type) + "(...) takes one value");
  return poisoned;
}

Type Checker::checkCast(Expression& expression, Construct& construct, const Type& type) {
  Expression& argument = *construct.arguments.front();
  if (std::holds_alternative<InitializerList>(argument.node)) {
    checkInitializer(argument, type, "the value");
    return type;
  }
  const Type from = check(argument, type);
  if (isPoisoned(from)) return poisoned;
  const bool narrowing = type == types::integer && from == types::floating;
  if (narrowing || (!from.isArray() && isAssignable(type, from))) return type;
  if (type == types::closure && isZeroLiteral(argument)) return type;
  error(expression.position, "a value of type " + toString(from) + " cannot be cast to " + toString(type));
  return poisoned;
}

Type Checker::checkTriple(Expression& expression, Construct& construct, const Type& type) {
  auto& arguments = construct.arguments;
  const Type first = check(*arguments[0], types::none);
  const bool hasSpace = first == types::string;
  const std::size_t begin = hasSpace ? 1 : 0;
  const std::size_t count = arguments.size() - begin;
  if (count != 3 && (strict_ || !(hasSpace && count == 1))) {
    for (std::size_t i = 1; i < arguments.size(); ++i) check(*arguments[i], types::floating);
    const std::string name = toString(type);
    error(expression.position, name + "(...) takes three numbers, with a space before them if wanted",
          {name + "(x, y, z)", name + "(\"space\", x, y, z)"});
    return poisoned;
  }
  for (std::size_t i = begin; i < arguments.size(); ++i) {
    check(*arguments[i], types::floating);
    requireAssignable(types::floating, *arguments[i], "this component");
  }
  if (hasSpace && type == types::color) {
    checkColorSpace(*arguments[0]);
    construct.function = libraryFunction("transformc", 3, expression.position);
    if (!construct.function) return poisoned;
  }
  return type;
}

void Checker::checkColorSpace(const Expression& space) {
  const auto* literal = std::get_if<StringLiteral>(&space.node);
  if (!literal || std::find(colorSpaces.begin(), colorSpaces.end(), literal->value) != colorSpaces.end()) return;
  // Any other name may be one of the colour configuration's. A slip of the pen is told.
  const std::vector<std::string> known(colorSpaces.begin(), colorSpaces.end());
  if (literal->value.size() > 4 || nearestNames(literal->value, known, 1).empty()) return;
  warning(space.position, "\"" + literal->value + "\" is none of the language's colour spaces",
          {didYouMean(literal->value, known)});
}

Type Checker::checkMatrix(Expression& expression, Construct& construct) {
  auto& arguments = construct.arguments;
  for (const ExpressionPtr& argument : arguments) check(*argument, types::floating);
  const auto isString = [&](std::size_t i) { return i < arguments.size() && arguments[i]->type == types::string; };
  if (arguments.size() == 2 && isString(0) && isString(1)) return types::matrix;
  const std::size_t begin = isString(0) ? 1 : 0;
  const std::size_t count = arguments.size() - begin;
  if (count != 16 && !(begin == 1 && count == 1)) {
    error(expression.position,
          "matrix(...) takes 16 numbers, or one, with a space before them if wanted, or two names of spaces",
          {"matrix(diagonal)", "matrix(\"space\", diagonal)", "matrix(\"from\", \"to\")"});
    return poisoned;
  }
  for (std::size_t i = begin; i < arguments.size(); ++i)
    requireAssignable(types::floating, *arguments[i], "this element");
  return types::matrix;
}

Type Checker::checkStructConstructor(Expression& expression, std::vector<ExpressionPtr>& arguments,
                                     const StructType& type, Position position) {
  const Type result{BaseType::structure, false, Type::scalar, &type};
  if (arguments.size() == 1 && type.fields.size() != 1) {
    // A cast of a structure to its own type.
    if (!std::holds_alternative<InitializerList>(arguments[0]->node) && check(*arguments[0], result) == result)
      return result;
  }
  if (arguments.size() != type.fields.size()) {
    for (const ExpressionPtr& argument : arguments)
      if (!std::holds_alternative<InitializerList>(argument->node)) check(*argument, types::none);
    std::string note = type.name + "(";
    for (std::size_t i = 0; i < type.fields.size(); ++i)
      note += (i > 0 ? ", " : "") + toString(type.fields[i].type) + " " + type.fields[i].name;
    error(position,
          "structure '" + type.name + "' takes " + std::to_string(type.fields.size()) + " values, one a field, not " +
              std::to_string(arguments.size()),
          {note + ")"});
    return poisoned;
  }
  for (std::size_t i = 0; i < arguments.size(); ++i)
    checkInitializer(*arguments[i], type.fields[i].type, "the value of field '" + type.fields[i].name + "'");
  expression.type = result;
  return result;
}

const FunctionDeclaration* Checker::libraryFunction(std::string_view name, std::size_t parameters, Position position,
                                                    const Type& last) {
  const auto found = scopes_.front().functions.find(name);
  if (found != scopes_.front().functions.end()) {
    for (const FunctionDeclaration* function : found->second) {
      if (function->parameters.size() != parameters || !sourceMap_.isInPrelude(function->position)) continue;
      if (!(last == types::none) && !(function->parameters.back()->type == last)) continue;
      useFunction(*function, position);
      return function;
    }
  }
  error(position, "the standard library lacks the function '" + std::string(name) + "'");
  return nullptr;
}

}  // namespace aerosol::lang

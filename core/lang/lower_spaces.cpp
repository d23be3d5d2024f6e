// Named coordinate systems and units. A matrix between two spaces is a call of `getmatrix_i_ssm` (from, to, matrix),
// which gives 1 and writes the matrix when both names are known, and otherwise gives 0 and leaves the matrix alone.
#include <algorithm>
#include <array>
#include <string_view>

#include "core/lang/lowerer.h"
#include "core/lang/units.h"

namespace aerosol::lang {

namespace {

/// Spaces that always exist: `getmatrix` between them cannot fail. "world" is "common".
constexpr std::array<std::string_view, 4> sureSpaces = {"common", "world", "object", "shader"};

bool isSure(const std::optional<Constant>& name) {
  return name && std::find(sureSpaces.begin(), sureSpaces.end(), name->asString()) != sureSpaces.end();
}

std::string canonical(const std::string& name) { return name == "world" ? "common" : name; }

}  // namespace

VariableId Lowerer::spaceMatrix(VariableId from, VariableId to) {
  const auto knownFrom = constantOf(from), knownTo = constantOf(to);
  const bool sure = isSure(knownFrom) && isSure(knownTo);
  if (knownFrom && knownTo && canonical(knownFrom->asString()) == canonical(knownTo->asString()))
    return constant(*convertConstant(Constant::ofFloat(1), types::matrix));
  VariableId matrix = noVariable;
  if (sure) {
    matrix = temporary(types::matrix);
  } else {
    // An unknown space counts as "common": the identity.
    matrix = local(types::matrix, "");
    assign(matrix, constant(*convertConstant(Constant::ofFloat(1), types::matrix)));
  }
  call("getmatrix", types::integer, {from, to, matrix}, 1u << 2);
  if (!code_->empty()) code_->back().quiet = namesMayBeUnits_;
  return matrix;
}

Value Lowerer::transformBy(VariableId matrix, const Value& value) {
  const char* base = value.type.base == BaseType::point    ? "transformp"
                     : value.type.base == BaseType::normal ? "transformn"
                                                           : "transformv";
  return {value.type, {call(base, value.type, {matrix, value.single()})}};
}

Value Lowerer::betweenSpaces(VariableId from, VariableId to, const Value& value) {
  const VariableId matrix = spaceMatrix(from, to);
  if (const auto known = constantOf(matrix)) return value;
  return transformBy(matrix, value);
}

Value Lowerer::lowerTransform(const Expression& expression, const Call& called) {
  std::vector<Value> arguments = lowerArguments(called);
  const Type type = called.builtin->result;
  position_ = expression.position;
  Value value = arguments.back();
  value.type = type;
  if (arguments[0].type == types::matrix) return transformBy(arguments[0].single(), value);
  if (arguments.size() == 2) return betweenSpaces(constantString("common"), arguments[0].single(), value);
  return betweenSpaces(arguments[0].single(), arguments[1].single(), value);
}

/// Lengths convert by their units; a space's unit is the length in it of a vector of one metre, where one unit of
/// "common" is one metre.
Value Lowerer::lowerTransformUnits(const Expression& expression, const Call& called) {
  const std::vector<Value> arguments = lowerArguments(called);
  std::array<std::string, 2> names = {"common", "common"};
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
    const auto name = constantOf(arguments[i].single());
    if (!name) return lowerRunTimeUnits(arguments, expression.position);
    names[arguments.size() == 2 ? 1 : i] = name->asString();
  }
  position_ = expression.position;
  const Unit* from = findUnit(names[0]);
  const Unit* to = findUnit(names[1]);
  if (names[0] == names[1]) return {types::floating, {arguments.back().single()}};
  if (names[0] == "frames" || names[1] == "frames") {
    error(expression.position, "the unit \"frames\" is not known here: a shader sees no frame rate");
    return zeroValue(types::floating);
  }
  const bool fromTime = from && from->isTime, toTime = to && to->isTime;
  const bool commonTime = (fromTime && names[1] == "common") || (toTime && names[0] == "common");
  if (fromTime != toTime && !commonTime) {
    error(expression.position,
          "\"" + names[0] + "\" and \"" + names[1] + "\" are not both units of length or both of time");
    return zeroValue(types::floating);
  }
  const VariableId x = arguments.back().single();
  if (fromTime || toTime) return {types::floating, {x}};
  // Into metres of "common" space, from there into the target.
  VariableId value = x;
  const auto scaled = [&](VariableId length, const std::string& space, bool toCommon) {
    if (canonical(space) == "common") return length;
    const Value axis{types::vector,
                     {emit(Op::makeTriple, types::vector, {length, constantFloat(0), constantFloat(0)})}};
    const VariableId name = constantString(space), common = constantString("common");
    const Value moved = toCommon ? betweenSpaces(name, common, axis) : betweenSpaces(common, name, axis);
    return call("length", types::floating, {moved.single()});
  };
  if (!from) value = scaled(value, names[0], true);
  const double factor = (from ? from->size : 1.0) / (to ? to->size : 1.0);
  if (factor != 1.0) value = emit(Op::multiply, types::floating, {value, constantFloat(static_cast<float>(factor))});
  if (!to) value = scaled(value, names[1], false);
  return {types::floating, {value}};
}

/// Names that are known when the shader runs: each is looked for among units and among spaces, and what it is not
/// leaves the length as it is. (Here the two kinds of units are not told apart.)
Value Lowerer::lowerRunTimeUnits(const std::vector<Value>& arguments, Position position) {
  position_ = position;
  namesMayBeUnits_ = true;
  const VariableId common = constantString("common");
  const VariableId from = arguments.size() == 3 ? arguments[0].single() : common;
  const VariableId to = arguments[arguments.size() - 2].single();
  const Value axis{types::vector, {constant({types::vector, std::vector<float>{1, 0, 0}})}};
  const auto lengthOfAxis = [&](VariableId source, VariableId target) {
    return call("length", types::floating, {betweenSpaces(source, target, axis).single()});
  };
  VariableId value = arguments.back().single();
  for (const VariableId factor :
       {lengthOfAxis(from, common), callHost("unitratio", types::floating, {from, to}, {}), lengthOfAxis(common, to)})
    value = emit(Op::multiply, types::floating, {value, factor});
  namesMayBeUnits_ = false;
  return {types::floating, {value}};
}

Value Lowerer::lowerGetMatrix(const Call& called) {
  const VariableId from = copied(lower(*called.arguments[0])).single();
  const VariableId to = copied(lower(*called.arguments[1])).single();
  const Place target = place(*called.arguments[2]);
  VariableId matrix = target.leaves[0];
  if (!target.isWhole()) {
    matrix = local(types::matrix, "");
    assign(matrix, load(target).single());
  }
  const VariableId found = call("getmatrix", types::integer, {from, to, matrix}, 1u << 2);
  if (!target.isWhole()) store(target, {types::matrix, {matrix}});
  return {types::integer, {found}};
}

Value Lowerer::lowerMatrixConstruct(const Construct& construct) {
  const auto& arguments = construct.arguments;
  const bool hasSpace = arguments[0]->type == types::string;
  const auto lowered = [&](std::size_t i, const Type& type) {
    return protect(lowerTo(*arguments[i], type), std::span(arguments).subspan(i + 1)).single();
  };
  if (hasSpace && arguments[1]->type == types::string) {
    const VariableId from = lowered(0, types::string);
    return {types::matrix, {spaceMatrix(from, lowered(1, types::string))}};
  }
  VariableId space = noVariable;
  if (hasSpace) space = lowered(0, types::string);
  std::vector<VariableId> elements;
  for (std::size_t i = hasSpace ? 1 : 0; i < arguments.size(); ++i) elements.push_back(lowered(i, types::floating));
  const VariableId matrix = elements.size() == 1 ? emit(Op::toMatrix, types::matrix, {elements[0]})
                                                 : emit(Op::makeMatrix, types::matrix, std::move(elements));
  if (!hasSpace) return {types::matrix, {matrix}};
  // The numbers are relative to the space: with row vectors they come first, the way to "common" after them.
  const VariableId toCommon = spaceMatrix(space, constantString("common"));
  const Constant identity = *convertConstant(Constant::ofFloat(1), types::matrix);
  const auto known = constantOf(matrix);
  if (known && sameBits(*known, identity)) return {types::matrix, {toCommon}};
  return {types::matrix, {emit(Op::multiply, types::matrix, {matrix, toCommon})}};
}

}  // namespace aerosol::lang

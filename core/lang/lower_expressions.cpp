#include <algorithm>
#include <array>

#include "core/lang/lowerer.h"

namespace aerosol::lang {

namespace {

/// How deep lowering follows expressions, statements and functions into each other: stack is what this saves.
constexpr int maximumLoweringDepth = 4000;

constexpr std::array<Op, 18> binaryOps = {Op::add,      Op::subtract,   Op::multiply, Op::divide,       Op::modulo,
                                          Op::bitAnd,   Op::bitOr,      Op::bitXor,   Op::shiftLeft,    Op::shiftRight,
                                          Op::less,     Op::lessEqual,  Op::greater,  Op::greaterEqual, Op::equal,
                                          Op::notEqual, Op::logicalAnd, Op::logicalOr};

bool isClosureNumber(const Type& type) { return type.closure; }

}  // namespace

Value Lowerer::lower(const Expression& expression) {
  if (depth_ > maximumLoweringDepth) stop(expression.position, "expressions and functions are nested too deeply here");
  if (failed_) return zeroValue(expression.type);
  const Position outer = std::exchange(position_, expression.position);
  ++depth_;
  Value value = lowerNode(expression);
  --depth_;
  position_ = outer;
  return value;
}

Value Lowerer::lowerTo(const Expression& expression, const Type& type) {
  if (const auto* list = std::get_if<InitializerList>(&expression.node)) return lowerList(*list, type);
  return convert(lower(expression), type);
}

Value Lowerer::lowerNode(const Expression& expression) {
  const auto& node = expression.node;
  if (const auto* literal = std::get_if<IntLiteral>(&node)) return {types::integer, {constantInt(literal->value)}};
  if (const auto* literal = std::get_if<FloatLiteral>(&node)) return {types::floating, {constantFloat(literal->value)}};
  if (const auto* literal = std::get_if<StringLiteral>(&node)) return {types::string, {constantString(literal->value)}};
  if (const auto* name = std::get_if<Name>(&node)) return variableValue(*name);
  if (const auto* unary = std::get_if<Unary>(&node)) return lowerUnary(expression, *unary);
  if (const auto* binary = std::get_if<Binary>(&node)) return lowerBinary(expression, *binary);
  if (const auto* assigned = std::get_if<Assign>(&node)) return lowerAssign(expression, *assigned);
  if (const auto* conditional = std::get_if<Conditional>(&node)) return lowerConditional(expression, *conditional);
  if (std::holds_alternative<Index>(node) || std::holds_alternative<Field>(node)) return load(place(expression));
  if (const auto* called = std::get_if<Call>(&node)) return lowerCall(expression, *called);
  if (const auto* construct = std::get_if<Construct>(&node)) return lowerConstruct(expression, *construct);
  if (const auto* list = std::get_if<InitializerList>(&node)) return lowerList(*list, expression.type);
  const auto& comma = std::get<Comma>(node);
  lower(*comma.first);
  return lower(*comma.second);
}

VariableId Lowerer::toBool(VariableId variable) {
  if (typeOf(variable).closure || typeOf(variable).isArray()) {
    Instruction& instruction = append(Op::toBool);
    const VariableId result = temporary(types::integer);
    instruction.result = result;
    instruction.arguments = {variable};
    return result;
  }
  return emit(Op::toBool, types::integer, {variable});
}

VariableId Lowerer::lowerCondition(const Expression& expression) { return toBool(lower(expression).single()); }

VariableId Lowerer::convertLeaf(VariableId variable, const Type& to) {
  const Type from = typeOf(variable);
  if (from == to || from.isArray() || to.isArray()) return variable;
  if (to.closure) return from.closure ? variable : constant(zeroConstant(to));
  if (from.isTriple()) return variable;
  if (to == types::integer) return from == types::floating ? emit(Op::toInt, to, {variable}) : variable;
  if (from == types::integer && to.base != BaseType::string) variable = emit(Op::toFloat, types::floating, {variable});
  if (to.isTriple()) return emit(Op::toTriple, to, {variable});
  if (to == types::matrix) return emit(Op::toMatrix, to, {variable});
  return variable;
}

Value Lowerer::convert(const Value& value, const Type& type) {
  Value result{type, value.leaves};
  if (type.base == BaseType::structure || type == types::none) return result;
  if (type.isArray()) {
    if (type.arrayLength == Type::unsized) result.type = value.type;
    if (type.arrayLength <= value.type.arrayLength || !value.type.isArray()) return result;
    const VariableId longer = local(type, "");
    if (loopDepth_ > 0) assign(longer, constant(zeroConstant(type)));
    copyPrefix(longer, value.single());
    result.leaves = {longer};
    return result;
  }
  result.leaves = {convertLeaf(value.single(), type)};
  return result;
}

Value Lowerer::copied(const Value& value) {
  Value copy = value;
  for (VariableId& leaf : copy.leaves) {
    if (!isMutable(leaf)) continue;
    const Type type = typeOf(leaf);
    const VariableId target = type.isArray() ? local(type, "") : temporary(type);
    Instruction& instruction = append(Op::assign);
    instruction.result = target;
    instruction.arguments = {leaf};
    leaf = target;
  }
  return copy;
}

Value Lowerer::protect(Value value, const Expression& next) {
  const bool isSafe =
      std::none_of(value.leaves.begin(), value.leaves.end(), [&](auto leaf) { return isMutable(leaf); });
  if (isSafe || !hasEffects(next)) return value;
  return copied(value);
}

Value Lowerer::protect(Value value, std::span<const ExpressionPtr> next) {
  const bool changes =
      std::any_of(value.leaves.begin(), value.leaves.end(), [&](auto leaf) { return isMutable(leaf); }) &&
      std::any_of(next.begin(), next.end(), [](const auto& one) { return hasEffects(*one); });
  return changes ? copied(value) : value;
}

Value Lowerer::lowerUnary(const Expression& expression, const Unary& unary) {
  if (unary.function) return callFunction(*unary.function, {&unary.operand, 1}, expression.position);
  switch (unary.op) {
    case UnaryOp::plus:
      return lower(*unary.operand);
    case UnaryOp::minus: {
      const Value operand = lower(*unary.operand);
      if (operand.type.closure)
        return {operand.type, {emit(Op::closureScale, operand.type, {operand.single(), constantFloat(-1)})}};
      return {expression.type, {emit(Op::negate, expression.type, {operand.single()})}};
    }
    case UnaryOp::logicalNot: {
      const VariableId truth = lowerCondition(*unary.operand);
      return {types::integer, {emit(Op::logicalNot, types::integer, {truth})}};
    }
    case UnaryOp::bitNot:
      return {types::integer, {emit(Op::bitNot, types::integer, {lower(*unary.operand).single()})}};
    default:
      return lowerIncrement(expression, unary);
  }
}

Value Lowerer::lowerIncrement(const Expression& expression, const Unary& unary) {
  const bool increments = unary.op == UnaryOp::preIncrement || unary.op == UnaryOp::postIncrement;
  const bool givesOld = unary.op == UnaryOp::postIncrement || unary.op == UnaryOp::postDecrement;
  const Type type = expression.type;
  const Place target = place(*unary.operand);
  Value old = load(target);
  if (givesOld) old = copied(old);
  const VariableId one = type == types::integer ? constantInt(1) : constantFloat(1);
  const Value changed{type, {emit(increments ? Op::add : Op::subtract, type, {old.single(), one})}};
  store(target, changed);
  if (givesOld) return old;
  return target.isWhole() ? load(target) : changed;
}

Value Lowerer::lowerBinary(const Expression& expression, const Binary& binary) {
  if (binary.function) {
    const std::array<ExpressionPtr*, 2> operands = {const_cast<ExpressionPtr*>(&binary.left),
                                                    const_cast<ExpressionPtr*>(&binary.right)};
    std::vector<Value> values;
    values.push_back(protect(lowerTo(**operands[0], binary.function->parameters[0]->type), *binary.right));
    values.push_back(lowerTo(**operands[1], binary.function->parameters[1]->type));
    return inlineFunction(*binary.function, std::move(values), expression.position);
  }
  if (binary.op == BinaryOp::logicalAnd || binary.op == BinaryOp::logicalOr) return lowerLogical(binary);
  Value left = protect(lower(*binary.left), *binary.right);
  Value right = lower(*binary.right);
  return arithmetic(binary.op, expression.type, std::move(left), std::move(right));
}

Value Lowerer::arithmetic(BinaryOp op, const Type& result, Value left, Value right) {
  if (left.type.closure || right.type.closure) return closureArithmetic(op, left, right);
  // Ints beside anything else count as floats; a float beside a triple serves all components.
  const bool bothInts = left.type == types::integer && right.type == types::integer;
  if (!bothInts) {
    if (left.type == types::integer) left = convert(left, types::floating);
    if (right.type == types::integer) right = convert(right, types::floating);
  }
  const bool comparison = op == BinaryOp::equal || op == BinaryOp::notEqual;
  if (comparison && left.type == types::matrix) right = convert(right, types::matrix);
  if (comparison && right.type == types::matrix) left = convert(left, types::matrix);
  return {result, {emit(binaryOps[static_cast<std::size_t>(op)], result, {left.single(), right.single()})}};
}

Value Lowerer::closureArithmetic(BinaryOp op, const Value& left, const Value& right) {
  const Type type = types::closure;
  const bool leftIsClosure = isClosureNumber(left.type);
  switch (op) {
    case BinaryOp::add:
      return {type, {emit(Op::closureAdd, type, {left.single(), right.single()})}};
    case BinaryOp::subtract: {
      const VariableId negated = emit(Op::closureScale, type, {right.single(), constantFloat(-1)});
      return {type, {emit(Op::closureAdd, type, {left.single(), negated})}};
    }
    default:
      break;
  }
  Value weight = leftIsClosure ? right : left;
  if (weight.type == types::integer) weight = convert(weight, types::floating);
  VariableId factor = weight.single();
  if (op == BinaryOp::divide) factor = emit(Op::divide, weight.type, {constantFloat(1), factor});
  return {type, {emit(Op::closureScale, type, {leftIsClosure ? left.single() : right.single(), factor})}};
}

Value Lowerer::lowerLogical(const Binary& binary) {
  const bool isAnd = binary.op == BinaryOp::logicalAnd;
  const VariableId left = lowerCondition(*binary.left);
  if (const auto known = constantOf(left)) {
    if ((known->asInt() != 0) != isAnd) return {types::integer, {left}};
    return {types::integer, {lowerCondition(*binary.right)}};
  }
  if (isCheap(*binary.right)) {
    const VariableId right = lowerCondition(*binary.right);
    return {types::integer, {emit(isAnd ? Op::logicalAnd : Op::logicalOr, types::integer, {left, right})}};
  }
  const VariableId result = local(types::integer, "");
  append(Op::assign).result = result;
  code_->back().arguments = {left};
  const auto evaluate = [&] { assign(result, lowerCondition(*binary.right)); };
  if (isAnd) {
    branch(left, evaluate, [] {});
  } else {
    branch(left, [] {}, evaluate);
  }
  truths_.insert(result);
  return {types::integer, {result}};
}

Value Lowerer::lowerAssign(const Expression& expression, const Assign& assigned) {
  const Type type = assigned.target->type;
  if (!assigned.compound) {
    const Place target = place(*assigned.target);
    // What the target's indices were computed from may change while the value is computed; they are temporaries.
    // A longer array keeps its last elements.
    const bool isArray = type.isArray() && !std::holds_alternative<InitializerList>(assigned.value->node);
    Value value = isArray ? lower(*assigned.value) : lowerTo(*assigned.value, type);
    position_ = expression.position;
    store(target, value);
    return target.isWhole() ? load(target) : value;
  }
  const Place target = place(*assigned.target);
  Value old = protect(load(target), *assigned.value);
  Value result;
  if (assigned.function) {
    std::vector<Value> values = {convert(old, assigned.function->parameters[0]->type),
                                 lowerTo(*assigned.value, assigned.function->parameters[1]->type)};
    result = inlineFunction(*assigned.function, std::move(values), expression.position);
  } else {
    Value value = lower(*assigned.value);
    const bool ints = old.type == types::integer && value.type == types::integer;
    const Type wanted = type == types::integer && !ints ? types::floating : type;
    result = arithmetic(assigned.op, wanted, std::move(old), std::move(value));
  }
  result = convert(result, type);
  position_ = expression.position;
  store(target, result);
  return target.isWhole() ? load(target) : result;
}

Value Lowerer::lowerConditional(const Expression& expression, const Conditional& conditional) {
  const Type type = expression.type;
  const VariableId condition = lowerCondition(*conditional.condition);
  if (const auto known = constantOf(condition))
    return lowerTo(known->asInt() != 0 ? *conditional.yes : *conditional.no, type);
  const bool isPlain = !type.closure && !type.isArray() && type.base != BaseType::structure;
  if (isPlain && isCheap(*conditional.yes) && isCheap(*conditional.no)) {
    const VariableId yes = lowerSingle(*conditional.yes, type), no = lowerSingle(*conditional.no, type);
    return {type, {emit(Op::select, type, {condition, yes, no})}};
  }
  const Value result = localValue(type, "");
  branch(
      condition, [&] { assign(result, lowerTo(*conditional.yes, type)); },
      [&] { assign(result, lowerTo(*conditional.no, type)); });
  return result;
}

Value Lowerer::lowerConstruct(const Expression& expression, const Construct& construct) {
  const Type type = expression.type;
  const auto& arguments = construct.arguments;
  if (type.base == BaseType::structure) {
    if (arguments.size() == 1 && type.structure->fields.size() != 1) return lower(*arguments[0]);
    Value result{type, {}};
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      Value field = lowerTo(*arguments[i], type.structure->fields[i].type);
      field = protect(std::move(field), std::span(arguments).subspan(i + 1));
      result.leaves.insert(result.leaves.end(), field.leaves.begin(), field.leaves.end());
    }
    return result;
  }
  if (arguments.size() == 1) return lowerTo(*arguments[0], type);
  if (type == types::matrix) return lowerMatrixConstruct(construct);
  const bool hasSpace = arguments[0]->type == types::string;
  std::vector<VariableId> components;
  VariableId space = noVariable;
  if (hasSpace) space = protect(lower(*arguments[0]), std::span(arguments).subspan(1)).single();
  for (std::size_t i = hasSpace ? 1 : 0; i < arguments.size(); ++i) {
    const Value component = convert(lower(*arguments[i]), types::floating);
    components.push_back(protect(component, std::span(arguments).subspan(i + 1)).single());
  }
  const VariableId triple = components.size() == 1 ? emit(Op::toTriple, type, {components[0]})
                                                   : emit(Op::makeTriple, type, std::move(components));
  if (!hasSpace) return {type, {triple}};
  if (construct.function) {
    std::vector<Value> values = {{types::string, {space}}, {types::string, {constantString("rgb")}}, {type, {triple}}};
    return inlineFunction(*construct.function, std::move(values), expression.position);
  }
  return betweenSpaces(space, constantString("common"), {type, {triple}});
}

Value Lowerer::lowerList(const InitializerList& list, const Type& type) {
  if (type.isArray()) return lowerArrayList(list, type);
  if (type.base == BaseType::structure) {
    Value result{type, {}};
    for (std::size_t i = 0; i < list.elements.size(); ++i) {
      Value field = lowerTo(*list.elements[i], type.structure->fields[i].type);
      field = protect(std::move(field), std::span(list.elements).subspan(i + 1));
      result.leaves.insert(result.leaves.end(), field.leaves.begin(), field.leaves.end());
    }
    for (std::size_t i = list.elements.size(); i < type.structure->fields.size(); ++i) {
      const Value field = zeroValue(type.structure->fields[i].type);
      result.leaves.insert(result.leaves.end(), field.leaves.begin(), field.leaves.end());
    }
    return result;
  }
  if (list.elements.empty()) return zeroValue(type);
  if (list.elements.size() == 1) return lowerTo(*list.elements[0], type);
  std::vector<VariableId> components;
  for (std::size_t i = 0; i < list.elements.size(); ++i) {
    const Value component = lowerTo(*list.elements[i], types::floating);
    components.push_back(protect(component, std::span(list.elements).subspan(i + 1)).single());
  }
  return {type, {emit(type == types::matrix ? Op::makeMatrix : Op::makeTriple, type, std::move(components))}};
}

Value Lowerer::lowerArrayList(const InitializerList& list, const Type& type) {
  Type sized = type;
  if (sized.arrayLength == Type::unsized) sized.arrayLength = static_cast<int>(list.elements.size());
  std::size_t last = list.elements.size();
  while (last > 0 && !hasEffects(*list.elements[last - 1])) --last;
  std::vector<Value> elements;
  for (std::size_t i = 0; i < list.elements.size(); ++i) {
    Value element = lowerTo(*list.elements[i], sized.element());
    elements.push_back(i + 1 < last ? copied(element) : std::move(element));
  }
  return gatherArray(elements, sized);
}

Value Lowerer::gatherArray(const std::vector<Value>& elements, const Type& type) {
  std::vector<Leaf> leaves;
  flatten(type, leaves);
  Value result{type, {}};
  for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf)
    result.leaves.push_back(gatherLeaf(elements, leaf, leaves[leaf].type));
  return result;
}

/// One leaf of all elements as an array: a constant where all are, otherwise a constant and what is set into a copy.
VariableId Lowerer::gatherLeaf(const std::vector<Value>& elements, std::size_t leaf, const Type& type) {
  Constant known = zeroConstant(type);
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto value = constantOf(elements[i].leaves[leaf]);
    if (!value) {
      unknown.push_back(i);
    } else if (!type.closure) {  // A constant closure is the null closure, as the array starts.
      setElement(known, i, *value);
    }
  }
  const VariableId base = constant(known);
  if (unknown.empty()) return base;
  const VariableId array = local(type, "");
  assign(array, base);
  for (const std::size_t i : unknown) {
    const VariableId index = constantInt(static_cast<std::int32_t>(i));
    if (!countWork(position_)) break;
    Instruction& instruction = append(Op::setElement);
    instruction.result = array;
    instruction.arguments = {index, elements[i].leaves[leaf]};
  }
  return array;
}

}  // namespace aerosol::lang

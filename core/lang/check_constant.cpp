#include <array>

#include "core/lang/checker.h"

namespace aerosol::lang {

namespace {

constexpr std::array<Op, 18> binaryOps = {Op::add,      Op::subtract,   Op::multiply, Op::divide,       Op::modulo,
                                          Op::bitAnd,   Op::bitOr,      Op::bitXor,   Op::shiftLeft,    Op::shiftRight,
                                          Op::less,     Op::lessEqual,  Op::greater,  Op::greaterEqual, Op::equal,
                                          Op::notEqual, Op::logicalAnd, Op::logicalOr};

std::optional<Constant> evaluateUnary(const Expression& expression, const Unary& unary) {
  const auto operand = evaluateConstant(*unary.operand);
  if (!operand || unary.function) return std::nullopt;
  const Constant* const argument = &*operand;
  switch (unary.op) {
    case UnaryOp::plus:
      return operand;
    case UnaryOp::minus:
      return foldOperation(Op::negate, expression.type, {&argument, 1});
    case UnaryOp::logicalNot:
      return foldOperation(Op::logicalNot, expression.type, {&argument, 1});
    case UnaryOp::bitNot:
      return foldOperation(Op::bitNot, expression.type, {&argument, 1});
    default:
      return std::nullopt;
  }
}

std::optional<Constant> evaluateBinary(const Expression& expression, const Binary& binary) {
  auto left = evaluateConstant(*binary.left), right = evaluateConstant(*binary.right);
  if (!left || !right || binary.function) return std::nullopt;
  if (binary.op == BinaryOp::logicalAnd || binary.op == BinaryOp::logicalOr) {
    for (auto* side : {&left, &right}) {
      const Constant* const argument = &**side;
      *side = foldOperation(Op::toBool, types::integer, {&argument, 1});
    }
  } else if (left->type.isNumber() != right->type.isNumber() || !(left->type == right->type)) {
    if (left->type == types::integer) left = convertConstant(*left, types::floating);
    if (right->type == types::integer) right = convertConstant(*right, types::floating);
  }
  if (!left || !right) return std::nullopt;
  const std::array<const Constant*, 2> arguments = {&*left, &*right};
  return foldOperation(binaryOps[static_cast<std::size_t>(binary.op)], expression.type, arguments);
}

/// The leaves of a list, one after the other, each converted to `element`.
std::optional<Constant> evaluateList(const std::vector<ExpressionPtr>& elements, const Type& type) {
  const bool isArray = type.isArray();
  if (type.base == BaseType::structure || type.closure) return std::nullopt;
  Constant result = zeroConstant(type);
  const Type element = isArray ? type.element() : leafCount(type) == 1 ? type : types::floating;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    auto value = evaluateConstant(*elements[i]);
    if (value) value = convertConstant(*value, element);
    if (!value) return std::nullopt;
    setElement(result, i, *value);
  }
  return result;
}

}  // namespace

std::optional<Constant> evaluateConstant(const Expression& expression) {
  const auto& node = expression.node;
  if (const auto* literal = std::get_if<IntLiteral>(&node)) return Constant::ofInt(literal->value);
  if (const auto* literal = std::get_if<FloatLiteral>(&node)) return Constant::ofFloat(literal->value);
  if (const auto* literal = std::get_if<StringLiteral>(&node)) return Constant::ofString(literal->value);
  if (const auto* unary = std::get_if<Unary>(&node)) return evaluateUnary(expression, *unary);
  if (const auto* binary = std::get_if<Binary>(&node)) return evaluateBinary(expression, *binary);
  if (const auto* conditional = std::get_if<Conditional>(&node)) {
    const auto condition = evaluateConstant(*conditional->condition);
    if (!condition) return std::nullopt;
    const Constant* const argument = &*condition;
    const auto truth = foldOperation(Op::toBool, types::integer, {&argument, 1});
    const auto value = evaluateConstant(truth->asInt() != 0 ? *conditional->yes : *conditional->no);
    return value ? convertConstant(*value, expression.type) : std::nullopt;
  }
  if (const auto* construct = std::get_if<Construct>(&node)) {
    if (construct->arguments.size() == 1) {
      const auto value = evaluateConstant(*construct->arguments.front());
      return value ? convertConstant(*value, expression.type) : std::nullopt;
    }
    const std::size_t count = construct->arguments.size();
    return count == leafCount(expression.type) ? evaluateList(construct->arguments, expression.type) : std::nullopt;
  }
  if (const auto* list = std::get_if<InitializerList>(&node)) {
    if (list->elements.empty() && !expression.type.isArray())
      return convertConstant(Constant::ofInt(0), expression.type);
    if (!expression.type.isArray() && list->elements.size() == 1) {
      const auto value = evaluateConstant(*list->elements.front());
      return value ? convertConstant(*value, expression.type) : std::nullopt;
    }
    return evaluateList(list->elements, expression.type);
  }
  return std::nullopt;
}

}  // namespace aerosol::lang

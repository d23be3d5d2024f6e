// Operators on whole values.
#include <algorithm>

#include "core/jit/lowering.h"

namespace aerosol::jit {

using lang::Instruction;
using lang::Op;

namespace {

constexpr std::size_t matrixSize = 16;

/// One number serves all components.
const Number& at(const Value& value, std::size_t i) { return value.size() == 1 ? value[0] : value[i]; }

}  // namespace

Number Lowering::integer(std::int32_t value) {
  return {Kind::integer, false, {e_.ir.getInt32(static_cast<std::uint32_t>(value))}};
}

Number Lowering::floating(double value) {
  return {Kind::floating, false, {llvm::ConstantFP::get(e_.ir.getFloatTy(), value)}};
}

void Lowering::write(const Instruction& instruction, lang::VariableId variable, const Value& value) {
  if (!uniformity_.needsBlend(instruction, variable)) return variables_.write(variable, value, nullptr);
  const Mask lanes = mask();
  variables_.write(variable, value, &lanes);
}

Number Lowering::binary(Op op, Number a, Number b) {
  if (a.kind != b.kind && a.kind == Kind::floating) b = unary(Op::toFloat, b);
  if (a.kind != b.kind && b.kind == Kind::floating) a = unary(Op::toFloat, a);
  if (op == Op::modulo && a.kind == Kind::floating) return callFunction("fmod_f_ff", {Value{a}, Value{b}}, {a.kind})[0];
  if (a.varying || b.varying) return domain_.binary(op, domain_.varying(a), domain_.varying(b));
  const bool isComparison = op >= Op::less && op <= Op::logicalOr;
  return {isComparison ? Kind::integer : a.kind, false, {domain_.scalars().binary(op, a.kind, a.parts[0], b.parts[0])}};
}

Number Lowering::unary(Op op, const Number& x) {
  if (x.varying) return domain_.unary(op, x);
  const Kind kind = op == Op::toFloat ? Kind::floating : op == Op::negate ? x.kind : Kind::integer;
  return {kind, false, {domain_.scalars().unary(op, x.kind, x.parts[0])}};
}

Number Lowering::select(const Number& condition, Number a, Number b) {
  if (a.kind != b.kind && a.kind == Kind::floating) b = unary(Op::toFloat, b);
  if (a.kind != b.kind && b.kind == Kind::floating) a = unary(Op::toFloat, a);
  if (!condition.varying) {
    llvm::Value* const isTrue = domain_.scalars().isTrue(condition.parts[0]);
    if (const auto* known = llvm::dyn_cast<llvm::ConstantInt>(isTrue)) return known->isZero() ? b : a;
    Number result{a.kind, a.varying || b.varying, {}};
    if (result.varying) a = domain_.varying(a);
    if (result.varying) b = domain_.varying(b);
    for (std::size_t part = 0; part < a.parts.size() && a.parts[part]; ++part) {
      result.parts[part] = e_.ir.CreateSelect(isTrue, a.parts[part], b.parts[part]);
    }
    return result;
  }
  return domain_.select(condition, domain_.varying(a), domain_.varying(b));
}

void Lowering::emitOperation(const Instruction& instruction) {
  switch (instruction.op) {
    case Op::component:
    case Op::matrixElement:
    case Op::element:
    case Op::setComponent:
    case Op::setMatrixElement:
    case Op::setElement:
      return emitIndexed(instruction);
    case Op::assign:
      if (variables_.isArray(instruction.result)) return copyArray(instruction);
      break;
    default:
      break;
  }
  write(instruction, instruction.result, operate(instruction));
  rememberTest(instruction);
}

Value Lowering::operate(const Instruction& instruction) {
  switch (instruction.op) {
    case Op::assign:
      return variables_.read(instruction.arguments[0]);
    case Op::toTriple:
      return Value(3, asFloat(number(instruction.arguments[0])));
    case Op::toMatrix: {
      Value matrix(matrixSize, floating(0));
      for (std::size_t i = 0; i < matrixSize; i += 5) matrix[i] = asFloat(number(instruction.arguments[0]));
      return matrix;
    }
    case Op::makeTriple:
    case Op::makeMatrix: {
      Value value;
      for (const lang::VariableId argument : instruction.arguments) value.push_back(asFloat(number(argument)));
      return value;
    }
    case Op::select:
      return selectValue(instruction);
    case Op::negate:
    case Op::bitNot:
    case Op::logicalNot:
    case Op::toFloat:
    case Op::toInt:
    case Op::toBool:
      return operateUnary(instruction);
    default:
      return operateBinary(instruction);
  }
}

Value Lowering::operateUnary(const Instruction& instruction) {
  Value value = variables_.read(instruction.arguments[0]);
  for (Number& number : value) number = unary(instruction.op, number);
  if (instruction.op != Op::toBool) return value;
  for (std::size_t i = 1; i < value.size(); ++i) value[0] = binary(Op::logicalOr, value[0], value[i]);
  value.resize(1);
  return value;
}

Value Lowering::operateBinary(const Instruction& instruction) {
  const Value a = variables_.read(instruction.arguments[0]);
  if (instruction.op == Op::multiply && instruction.arguments[0] == instruction.arguments[1] && a.size() < matrixSize)
    return squares(a);
  const Value b = variables_.read(instruction.arguments[1]);
  if (instruction.op == Op::equal || instruction.op == Op::notEqual) return equality(instruction.op, a, b);
  if (instruction.op == Op::multiply || instruction.op == Op::divide) return multiplyOrDivide(instruction.op, a, b);
  Value result;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    result.push_back(binary(instruction.op, at(a, i), at(b, i)));
  }
  return result;
}

/// Number by number, of what is no matrix.
Value Lowering::squares(const Value& a) {
  Value result;
  for (const Number& x : a) result.push_back(x.varying ? domain_.square(x) : binary(Op::multiply, x, x));
  return result;
}

Value Lowering::equality(Op op, const Value& a, const Value& b) {
  Number result = binary(op, at(a, 0), at(b, 0));
  const Op join = op == Op::equal ? Op::logicalAnd : Op::logicalOr;
  for (std::size_t i = 1; i < std::max(a.size(), b.size()); ++i) {
    result = binary(join, result, binary(op, at(a, i), at(b, i)));
  }
  return {result};
}

/// Matrices multiply as such; dividing by one is multiplying by its inverse.
Value Lowering::multiplyOrDivide(Op op, const Value& a, const Value& b) {
  if (op == Op::divide && b.size() == matrixSize) {
    const Value inverse = callFunction("inverse_m_m", {b}, llvm::SmallVector<Kind>(matrixSize, Kind::floating));
    return multiplyOrDivide(Op::multiply, a, inverse);
  }
  if (a.size() == matrixSize && b.size() == matrixSize) return multiplyMatrices(a, b);
  Value result;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) result.push_back(binary(op, at(a, i), at(b, i)));
  return result;
}

Value Lowering::multiplyMatrices(const Value& a, const Value& b) {
  Value result;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      Number sum = binary(Op::multiply, a[row * 4], b[column]);
      for (std::size_t k = 1; k < 4; ++k) {
        sum = binary(Op::add, sum, binary(Op::multiply, a[row * 4 + k], b[k * 4 + column]));
      }
      result.push_back(sum);
    }
  }
  return result;
}

Value Lowering::selectValue(const Instruction& instruction) {
  const Number condition = number(instruction.arguments[0]);
  const Value a = readUnder(instruction.arguments[0], true, instruction.arguments[1]);
  const Value b = readUnder(instruction.arguments[0], false, instruction.arguments[2]);
  Value result;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
    result.push_back(select(condition, at(a, i), at(b, i)));
  return result;
}

}  // namespace aerosol::jit

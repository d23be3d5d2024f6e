// Components, matrix elements and array elements: indices are clamped, and reported where they were out of range.
#include <algorithm>

#include "core/jit/lowering.h"

namespace aerosol::jit {

using lang::Instruction;
using lang::Op;

namespace {

/// Arrays of so many numbers are copied one by one, longer ones by a loop.
constexpr unsigned unrolledCopy = 16;

const llvm::ConstantInt* constantIndex(const Number& index) {
  return index.varying ? nullptr : llvm::dyn_cast<llvm::ConstantInt>(index.parts[0]);
}

}  // namespace

void Lowering::emitIndexed(const Instruction& instruction) {
  const auto& arguments = instruction.arguments;
  switch (instruction.op) {
    case Op::component: {
      const Number index = checkedIndex(instruction, number(arguments[1]), 3, program_.variables[arguments[0]].name);
      write(instruction, instruction.result, {pick(variables_.read(arguments[0]), index)});
      return rememberTest(instruction);
    }
    case Op::matrixElement: {
      const Number index = matrixIndex(instruction, arguments[1], arguments[2]);
      return write(instruction, instruction.result, {pick(variables_.read(arguments[0]), index)});
    }
    case Op::element:
      return write(instruction, instruction.result, readElement(instruction));
    case Op::setComponent: {
      const std::string& name = program_.variables[instruction.result].name;
      return emitSetPart(instruction, checkedIndex(instruction, number(arguments[0]), 3, name), number(arguments[1]));
    }
    case Op::setMatrixElement:
      return emitSetPart(instruction, matrixIndex(instruction, arguments[0], arguments[1]), number(arguments[2]));
    default:
      return emitSetElement(instruction);
  }
}

Number Lowering::matrixIndex(const Instruction& instruction, lang::VariableId row, lang::VariableId column) {
  const bool isSet = instruction.op == Op::setMatrixElement;
  const std::string& name = program_.variables[isSet ? instruction.result : instruction.arguments[0]].name;
  const Number checkedRow = checkedIndex(instruction, number(row), 4, name);
  const Number checkedColumn = checkedIndex(instruction, number(column), 4, name);
  return binary(Op::add, binary(Op::multiply, checkedRow, integer(4)), checkedColumn);
}

/// The index within [0, length). Lanes where it was not leave a report.
Number Lowering::checkedIndex(const Instruction& instruction, const Number& index, unsigned length,
                              const std::string& name) {
  const auto* known = constantIndex(index);
  if (known && known->getValue().ult(length)) return index;
  llvm::Value* lanes = nullptr;
  const Mask running = mask();
  Number clamped;
  if (index.varying) {
    lanes = e_.both(running.may, domain_.outside(index, length));
    clamped = domain_.clampIndex(index, length);
  } else {
    llvm::Value* const x = index.parts[0];
    llvm::Value* const isOutside = e_.ir.CreateICmpUGE(x, e_.ir.getInt32(length));
    lanes = e_.ir.CreateSelect(isOutside, running.may, e_.noLanes());
    llvm::Value* const low = e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::smax, x, e_.ir.getInt32(0));
    llvm::Value* const both = e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::smin, low, e_.ir.getInt32(length - 1));
    clamped = {Kind::integer, false, {both}};
  }
  if (instruction.quiet) return clamped;
  report(AEROSOL_REPORT_INDEX, instruction.location, name, {lang::types::integer, lang::types::integer},
         {index, integer(static_cast<std::int32_t>(length))}, lanes);
  return clamped;
}

Number Lowering::pick(const Value& value, const Number& index) {
  if (const auto* known = constantIndex(index)) return value[known->getZExtValue()];
  Number result = value.back();
  for (std::size_t i = value.size() - 1; i-- > 0;) {
    result = select(binary(Op::equal, index, integer(static_cast<std::int32_t>(i))), value[i], result);
  }
  return result;
}

void Lowering::emitSetPart(const Instruction& instruction, const Number& index, const Number& part) {
  Value value = variables_.read(instruction.result);
  const Number set = asFloat(part);
  if (const auto* known = constantIndex(index)) {
    value[known->getZExtValue()] = set;
  } else {
    for (std::size_t i = 0; i < value.size(); ++i) {
      value[i] = select(binary(Op::equal, index, integer(static_cast<std::int32_t>(i))), set, value[i]);
    }
  }
  write(instruction, instruction.result, value);
}

llvm::Value* Lowering::elementAddress(const ArrayMemory& array, const Number& index) {
  llvm::Value* const offset = e_.ir.CreateMul(e_.ir.CreateZExt(index.parts[0], e_.ir.getInt64Ty()),
                                              e_.ir.getInt64(domain_.elementBytes(array.element, array.varying)));
  return e_.ir.CreateInBoundsGEP(e_.ir.getInt8Ty(), array.base, offset);
}

Value Lowering::readElement(const Instruction& instruction) {
  const lang::VariableId variable = instruction.arguments[0];
  const ArrayMemory array = variables_.array(variable);
  const Number index =
      checkedIndex(instruction, number(instruction.arguments[1]), array.length, program_.variables[variable].name);
  const auto components = static_cast<unsigned>(array.element.size());
  Value value;
  if (index.varying) {
    for (unsigned i = 0; i < components; ++i) value.push_back(domain_.readElement(array, index, i));
    return value;
  }
  llvm::Value* const address = elementAddress(array, index);
  for (unsigned i = 0; i < components; ++i) {
    const unsigned offset = domain_.componentOffset(array.element, i, array.varying);
    value.push_back(domain_.load(array.element[i], array.varying, e_.pointerAt(address, offset)));
  }
  return value;
}

void Lowering::emitSetElement(const Instruction& instruction) {
  const ArrayMemory array = variables_.array(instruction.result);
  const Number index = checkedIndex(instruction, number(instruction.arguments[0]), array.length,
                                    program_.variables[instruction.result].name);
  const Value value = variables_.read(instruction.arguments[1]);
  const Mask lanes = mask();
  const bool blends = uniformity_.needsBlend(instruction, instruction.result);
  for (unsigned i = 0; i < array.element.size(); ++i) {
    Number number = value[std::min<std::size_t>(i, value.size() - 1)];
    if (array.varying) number = domain_.varying(number);
    if (index.varying) {
      domain_.writeElement(array, index, i, number, lanes);
      continue;
    }
    const unsigned offset = domain_.componentOffset(array.element, i, array.varying);
    llvm::Value* const address = e_.pointerAt(elementAddress(array, index), offset);
    if (blends) number = domain_.blend(lanes, number, domain_.load(number.kind, true, address));
    domain_.store(number, address);
  }
}

void Lowering::copyArray(const Instruction& instruction) {
  const ArrayMemory to = variables_.array(instruction.result);
  const ArrayMemory from = variables_.array(instruction.arguments[0]);
  const Mask lanes = mask();
  copyElements(to, from, uniformity_.needsBlend(instruction, instruction.result) ? &lanes : nullptr);
}

void Lowering::copyElements(const ArrayMemory& to, const ArrayMemory& from, const Mask* blend) {
  const auto copyOne = [&](const Number& index) {
    llvm::Value* const source = elementAddress(from, index);
    llvm::Value* const target = elementAddress(to, index);
    for (unsigned i = 0; i < to.element.size(); ++i) {
      Number number = domain_.load(from.element[i], from.varying,
                                   e_.pointerAt(source, domain_.componentOffset(from.element, i, from.varying)));
      llvm::Value* const address = e_.pointerAt(target, domain_.componentOffset(to.element, i, to.varying));
      if (to.varying) number = domain_.varying(number);
      if (blend) number = domain_.blend(*blend, number, domain_.load(number.kind, true, address));
      domain_.store(number, address);
    }
  };
  if (to.length * to.element.size() <= unrolledCopy) {
    for (unsigned i = 0; i < to.length; ++i) copyOne(integer(static_cast<std::int32_t>(i)));
    return;
  }
  llvm::BasicBlock* const before = e_.ir.GetInsertBlock();
  llvm::BasicBlock* const loop = e_.block("copy");
  llvm::BasicBlock* const end = e_.block("copied");
  e_.enter(loop);
  llvm::PHINode* const index = e_.ir.CreatePHI(e_.ir.getInt32Ty(), 2);
  index->addIncoming(e_.ir.getInt32(0), before);
  copyOne({Kind::integer, false, {index}});
  llvm::Value* const next = e_.ir.CreateAdd(index, e_.ir.getInt32(1));
  index->addIncoming(next, e_.ir.GetInsertBlock());
  e_.ir.CreateCondBr(e_.ir.CreateICmpULT(next, e_.ir.getInt32(to.length)), loop, end);
  e_.ir.SetInsertPoint(end);
}

}  // namespace aerosol::jit

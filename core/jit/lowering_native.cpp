// Calls of functions of native plugins that are inlined, and calls over boxes of points: of plugins and of the host.
#include <cstddef>

#include "core/jit/lowering.h"
#include "core/jit/native_code.h"
#include "plugins/sdk/aerosol_shader.h"

namespace aerosol::jit {

using lang::Instruction;

/// AerosolLanes in memory.
llvm::Value* Lowering::lanesOfCall(bool varies) {
  const unsigned count = varies ? e_.width() : 1;
  llvm::Type* const word = e_.ir.getInt32Ty();
  llvm::Value* const rows = e_.slot(llvm::ArrayType::get(word, count), "native.mask", 64);
  llvm::Value* mask = varies ? e_.ir.CreateSExt(this->mask().may, e_.laneType(word)) : e_.ir.getInt32(~0u);
  e_.ir.CreateAlignedStore(mask, rows, llvm::Align(varies ? e_.laneBytes(Kind::integer) : 4));
  llvm::Value* const lanes =
      e_.slot(llvm::ArrayType::get(e_.ir.getInt8Ty(), sizeof(AerosolLanes)), "native.lanes", alignof(AerosolLanes));
  const auto set = [&](std::size_t offset, llvm::Value* value) {
    e_.ir.CreateStore(value, e_.pointerAt(lanes, offset));
  };
  set(offsetof(AerosolLanes, count), e_.ir.getInt32(count));
  set(offsetof(AerosolLanes, reserved), e_.ir.getInt32(0));
  set(offsetof(AerosolLanes, mask), rows);
  set(offsetof(AerosolLanes, host), e_.zero(e_.ir.getPtrTy()));
  return lanes;
}

/// An array of pointers in memory.
llvm::Value* Lowering::pointerTable(llvm::ArrayRef<llvm::Value*> pointers) {
  llvm::Type* const pointer = e_.ir.getPtrTy();
  llvm::Value* const table =
      e_.slot(llvm::ArrayType::get(pointer, std::max<std::size_t>(pointers.size(), 1)), "host.values");
  for (std::size_t i = 0; i < pointers.size(); ++i)
    e_.ir.CreateStore(pointers[i], e_.pointerAt(table, i * sizeof(void*)));
  return table;
}

void Lowering::emitNativeCall(const Instruction& instruction, bool varies) {
  const lang::NativeFunction& native = *program_.functions[instruction.function].native;
  llvm::SmallVector<llvm::Value*, 8> values;
  const bool hasResult = instruction.result != lang::noVariable;
  const llvm::ArrayRef<Kind> resultKinds = hasResult ? variables_.kinds(instruction.result) : llvm::ArrayRef<Kind>();
  if (hasResult) {
    Value zeros;
    for (const Kind kind : resultKinds) zeros.push_back(variables_.zero(kind));
    values.push_back(argumentMemory(zeros, varies));
  }
  // What is written to lanes that make no call is not used: arrays are written to copies.
  const auto copyOf = [&](lang::VariableId argument) {
    const llvm::ArrayRef<Kind> element = variables_.kinds(argument);
    const auto length = static_cast<unsigned>(program_.variables[argument].type.arrayLength);
    return ArrayMemory{variables_.memory(element, length, varies, "native.array"), element, length, varies};
  };
  std::vector<std::pair<lang::VariableId, ArrayMemory>> copies;
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    const lang::VariableId argument = instruction.arguments[i];
    if (!variables_.isArray(argument) || !lang::writesArgument(program_, instruction, i)) {
      values.push_back(hostArgument(instruction, i, varies));
      continue;
    }
    copies.emplace_back(argument, copyOf(argument));
    copyElements(copies.back().second, variables_.array(argument), nullptr);
    values.push_back(copies.back().second.base);
  }
  llvm::Type* const pointer = e_.ir.getPtrTy();
  auto* const type = llvm::FunctionType::get(e_.ir.getVoidTy(), {pointer, pointer}, false);
  const llvm::FunctionCallee function =
      e_.module().getOrInsertFunction(nativeCodeName(native, native.evaluateName), type);
  e_.ir.CreateCall(function, {lanesOfCall(varies), pointerTable(values)})->setDoesNotThrow();
  if (hasResult) write(instruction, instruction.result, loadValue(values[0], resultKinds, varies));
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    const lang::VariableId argument = instruction.arguments[i];
    if (!lang::writesArgument(program_, instruction, i) || variables_.isArray(argument)) continue;
    write(instruction, argument, loadValue(values[i + (hasResult ? 1 : 0)], variables_.kinds(argument), varies));
  }
  const Mask lanes = mask();
  for (const auto& [argument, copy] : copies) copyElements(variables_.array(argument), copy, varies ? &lanes : nullptr);
}

/// Whether something is known of the results over boxes.
bool Lowering::hasRange(const Instruction& instruction) const {
  const lang::FunctionUse& function = program_.functions[instruction.function];
  const bool isKnown = function.native ? function.native->hasRange
                                       : function.symbol == "texture" || function.symbol == "texture3d" ||
                                             function.symbol == "environment";
  if (!isKnown || instruction.result == lang::noVariable || variables_.isArray(instruction.result)) return false;
  return std::none_of(instruction.arguments.begin(), instruction.arguments.end(),
                      [&](lang::VariableId argument) { return variables_.isArray(argument); });
}

/// One end of each lane's range of a value: a row of lanes for each component.
llvm::Value* Lowering::endsMemory(const Value& value, unsigned end) {
  std::uint64_t bytes = 0;
  for (const Number& number : value) bytes += e_.laneBytes(number.kind);
  llvm::Value* const memory = e_.slot(llvm::ArrayType::get(e_.ir.getInt8Ty(), bytes), "ends", 64);
  std::uint64_t offset = 0;
  for (const Number& number : value) {
    const Number lanes = domain_.varying(number);
    // A string has one end.
    llvm::Value* const part = lanes.parts[number.kind == Kind::string ? 0 : end];
    e_.ir.CreateAlignedStore(part, e_.pointerAt(memory, offset), llvm::Align(e_.laneBytes(Kind::integer)));
    offset += e_.laneBytes(number.kind);
  }
  return memory;
}

/// Lanes in which the value may be NaN, or is not one known string.
llvm::Value* Lowering::unknownLanes(const Value& value) {
  llvm::Value* lanes = e_.noLanes();
  for (const Number& number : value) {
    if (number.kind == Kind::integer) continue;
    const Number varying = domain_.varying(number);
    llvm::Value* const flag = varying.parts[number.kind == Kind::string ? 1 : 2];
    lanes = e_.ir.CreateOr(lanes, e_.ir.CreateICmpNE(flag, e_.zero(flag->getType())));
  }
  return lanes;
}

/// What the rows of ends say; anything where they say nothing (NaN or in the wrong order), and where `unknown` is set.
Value Lowering::loadEnds(llvm::ArrayRef<Kind> kinds, llvm::Value* low, llvm::Value* high, llvm::Value* unknown) {
  Value value;
  std::uint64_t offset = 0;
  for (const Kind kind : kinds) {
    const llvm::Align alignment(e_.laneBytes(Kind::integer));
    llvm::Type* const type = e_.laneType(kind);
    llvm::Value* const ends[] = {e_.ir.CreateAlignedLoad(type, e_.pointerAt(low, offset), alignment),
                                 e_.ir.CreateAlignedLoad(type, e_.pointerAt(high, offset), alignment)};
    offset += e_.laneBytes(kind);
    Number number = domain_.anything(kind);
    if (kind != Kind::string) {
      llvm::Value* const isOrdered =
          kind == Kind::floating ? e_.ir.CreateFCmpOLE(ends[0], ends[1]) : e_.ir.CreateICmpSLE(ends[0], ends[1]);
      llvm::Value* const isKnown = e_.without(isOrdered, unknown);
      const Number nothing = number;
      if (kind == Kind::floating) {
        number = domain_.between(e_.ir.CreateSelect(isKnown, ends[0], e_.zero(type)),
                                 e_.ir.CreateSelect(isKnown, ends[1], e_.zero(type)));
      } else {
        number.parts[0] = ends[0];
        number.parts[1] = ends[1];
      }
      for (unsigned part = 0; part < domain_.partCount(kind); ++part)
        number.parts[part] = e_.ir.CreateSelect(isKnown, number.parts[part], nothing.parts[part]);
    }
    value.push_back(number);
  }
  return value;
}

void Lowering::emitRangeCall(const Instruction& instruction) {
  const lang::FunctionUse& function = program_.functions[instruction.function];
  llvm::SmallVector<llvm::Value*, 8> low, high;
  llvm::Value* unknown = e_.noLanes();
  const auto add = [&](const Value& value) {
    low.push_back(endsMemory(value, 0));
    high.push_back(endsMemory(value, 1));
  };
  const auto zeros = [&](lang::VariableId variable) {
    Value value;
    for (const Kind kind : variables_.kinds(variable)) value.push_back(variables_.zero(kind));
    return value;
  };
  add(zeros(instruction.result));
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    const lang::VariableId argument = instruction.arguments[i];
    const bool isFresh = lang::writesArgument(program_, instruction, i) &&
                         program_.variables[argument].storage == lang::Storage::temporary;
    const Value value = isFresh ? zeros(argument) : variables_.read(argument);
    add(value);
    if (!lang::writesArgument(program_, instruction, i)) unknown = e_.ir.CreateOr(unknown, unknownLanes(value));
  }
  llvm::Value* const lowTable = pointerTable(low);
  llvm::Value* const highTable = pointerTable(high);
  llvm::Type* const pointer = e_.ir.getPtrTy();
  if (function.native && function.native->bitcode) {
    auto* const type = llvm::FunctionType::get(e_.ir.getVoidTy(), {pointer, pointer, pointer}, false);
    const llvm::FunctionCallee called =
        e_.module().getOrInsertFunction(nativeCodeName(*function.native, function.native->rangeName), type);
    e_.ir.CreateCall(called, {lanesOfCall(true), lowTable, highTable})->setDoesNotThrow();
  } else {
    callHostService(instruction, lowTable, highTable, true);
  }
  if (function.native) interface_.hasDeclaredRanges = true;
  write(instruction, instruction.result, loadEnds(variables_.kinds(instruction.result), low[0], high[0], unknown));
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    if (!lang::writesArgument(program_, instruction, i)) continue;
    const lang::VariableId argument = instruction.arguments[i];
    write(instruction, argument, loadEnds(variables_.kinds(argument), low[i + 1], high[i + 1], unknown));
  }
}

}  // namespace aerosol::jit

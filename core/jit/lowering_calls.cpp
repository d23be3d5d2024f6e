// Library functions: arguments and results in memory, where inlining finds and removes it.
#include "core/jit/lowering.h"

namespace aerosol::jit {

using lang::Instruction;

llvm::Value* Lowering::argumentMemory(const Value& value, bool varying) {
  llvm::SmallVector<Kind, 4> kinds;
  for (const Number& number : value) kinds.push_back(number.kind);
  llvm::Value* const memory = variables_.memory(kinds, 1, varying, "argument");
  for (unsigned i = 0; i < value.size(); ++i) {
    const Number number = varying ? domain_.varying(value[i]) : value[i];
    domain_.store(number, e_.pointerAt(memory, domain_.componentOffset(kinds, i, varying)));
  }
  return memory;
}

llvm::Value* Lowering::argumentArray(const ArrayMemory& array, bool varying) {
  if (array.varying == varying) return array.base;
  const ArrayMemory copy{variables_.memory(array.element, array.length, varying, "argument"), array.element,
                         array.length, varying};
  copyElements(copy, array, nullptr);
  return copy.base;
}

Value Lowering::loadValue(llvm::Value* memory, llvm::ArrayRef<Kind> kinds, bool varying) {
  Value value;
  for (unsigned i = 0; i < kinds.size(); ++i) {
    value.push_back(domain_.load(kinds[i], varying, e_.pointerAt(memory, domain_.componentOffset(kinds, i, varying))));
  }
  return value;
}

void Lowering::emitFunctionCall(const std::string& symbol, bool varying, llvm::ArrayRef<llvm::Value*> pointers) {
  const std::string name = std::string(1, varying ? domain_.symbolPrefix() : 'u') + "_" + symbol;
  e_.callLibrary(name, pointers);
}

Value Lowering::callFunction(const std::string& symbol, llvm::ArrayRef<Value> arguments, llvm::ArrayRef<Kind> result) {
  bool varies = false;
  for (const Value& argument : arguments) {
    for (const Number& number : argument) varies = varies || number.varying;
  }
  llvm::SmallVector<llvm::Value*, 8> pointers = {variables_.memory(result, 1, varies, "result")};
  for (const Value& argument : arguments) pointers.push_back(argumentMemory(argument, varies));
  emitFunctionCall(symbol, varies, pointers);
  return loadValue(pointers[0], result, varies);
}

/// Is it P in the instance's object space? Ranges of that are known better than from P alone: a box of the object is
/// not a box of the world.
bool Lowering::isObjectPoint(const Instruction& instruction) const {
  if (program_.functions[instruction.function].symbol != "transformp_v_mv") return false;
  const lang::VariableId point = instruction.arguments[1];
  const lang::Variable& variable = program_.variables[point];
  return objectMatrices_.contains(instruction.arguments[0]) && variable.storage == lang::Storage::global &&
         variable.global == lang::Global::P && uniformity_.writeCount(point) == 0;
}

/// dot(v, v), of which a range knows more than of other products.
bool Lowering::isSquaredLength(const Instruction& instruction) const {
  return domain_.splitsMasks() && program_.functions[instruction.function].symbol == "dot_f_vv" &&
         instruction.arguments[0] == instruction.arguments[1] && uniformity_.isVarying(instruction.arguments[0]);
}

void Lowering::emitCall(const Instruction& instruction) {
  const lang::FunctionUse& function = program_.functions[instruction.function];
  if (isSquaredLength(instruction)) {
    const Value vector = variables_.read(instruction.arguments[0]);
    return write(instruction, instruction.result, callFunction("dot_f_v", {vector}, {Kind::floating}));
  }
  if (function.host) return emitHostCall(instruction);
  if (function.symbol == "getmatrix_i_ssm") return emitMatrixOfSpaces(instruction);
  bool varies = !function.pure;
  std::vector<Value> values;
  for (const lang::VariableId argument : instruction.arguments) {
    if (variables_.isArray(argument)) {
      varies = varies || variables_.array(argument).varying;
      values.emplace_back();
      continue;
    }
    // What is written is passed as well: a function may leave it as it is.
    const bool isOutput = lang::writesArgument(program_, instruction, values.size());
    const bool isFresh = isOutput && program_.variables[argument].storage == lang::Storage::temporary;
    Value value;
    if (isFresh) {
      for (const Kind kind : variables_.kinds(argument)) value.push_back(variables_.zero(kind));
    } else {
      value = variables_.read(argument);
    }
    for (const Number& number : value) varies = varies || number.varying;
    values.push_back(std::move(value));
  }
  if (varies && domain_.splitsMasks() && !e_.libraryHas(domain_.symbolPrefix() + ("_" + function.symbol))) {
    return widenResults(instruction);  // It has no rule for ranges.
  }
  llvm::SmallVector<llvm::Value*, 8> pointers;
  const bool hasResult = instruction.result != lang::noVariable;
  const llvm::ArrayRef<Kind> resultKinds = hasResult ? variables_.kinds(instruction.result) : llvm::ArrayRef<Kind>();
  if (hasResult) pointers.push_back(variables_.memory(resultKinds, 1, varies, "result"));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const lang::VariableId argument = instruction.arguments[i];
    pointers.push_back(variables_.isArray(argument) ? argumentArray(variables_.array(argument), varies)
                                                    : argumentMemory(values[i], varies));
  }
  emitFunctionCall(function.symbol, varies, pointers);
  if (hasResult) {
    Value result = loadValue(pointers[0], resultKinds, varies);
    if (varies && isObjectPoint(instruction)) {
      for (unsigned i = 0; i < result.size(); ++i) {
        const auto component = static_cast<unsigned>(globalPointerCount) + i;
        result[i] = domain_.narrowed(result[i], [&] { return frame_.global(component); });
      }
    }
    write(instruction, instruction.result, result);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!lang::writesArgument(program_, instruction, i)) continue;
    const lang::VariableId argument = instruction.arguments[i];
    write(instruction, argument, loadValue(pointers[i + (hasResult ? 1 : 0)], variables_.kinds(argument), varies));
  }
}

}  // namespace aerosol::jit

// Calls of the host's functions: values in memory, a row of lanes for each component, and one call a chunk.
#include <cstddef>

#include "core/jit/lowering.h"
#include "core/lang/native.h"

namespace aerosol::jit {

using lang::Instruction;

/// What the host must know of the call that does not change.
std::uint32_t Lowering::addHostSite(const Instruction& instruction) {
  const lang::FunctionUse& function = program_.functions[instruction.function];
  lang::HostSite site;
  site.function = function.symbol;
  site.location = program_.locations[instruction.location];
  if (instruction.result != lang::noVariable) site.result = program_.variables[instruction.result].type;
  site.outputs = function.outputs;
  for (const lang::VariableId argument : instruction.arguments) {
    const lang::Variable& variable = program_.variables[argument];
    site.arguments.push_back(variable.type);
    const bool isConstant = variable.storage == lang::Storage::constant;
    site.constants.push_back(isConstant ? variable.value : lang::ConstantValue{});
  }
  interface_.hostSites.push_back(std::move(site));
  if (!function.dependsOnArgumentsAlone()) interface_.dependsOnHost = interface_.readsInstances = true;
  return static_cast<std::uint32_t>(interface_.hostSites.size() - 1);
}

/// Memory with an argument's value. What is written is passed as well: a function may leave it as it is.
llvm::Value* Lowering::hostArgument(const Instruction& instruction, std::size_t index, bool varies) {
  const lang::VariableId argument = instruction.arguments[index];
  if (variables_.isArray(argument)) return argumentArray(variables_.array(argument), varies);
  const bool isOutput = lang::writesArgument(program_, instruction, index);
  const bool isFresh = isOutput && program_.variables[argument].storage == lang::Storage::temporary;
  Value value;
  if (isFresh) {
    for (const Kind kind : variables_.kinds(argument)) value.push_back(variables_.zero(kind));
  } else {
    value = variables_.read(argument);
  }
  return argumentMemory(value, varies);
}

/// Calls AerosolHostServices::call. `high`: of a call over boxes; otherwise null.
void Lowering::callHostService(const Instruction& instruction, llvm::Value* values, llvm::Value* high, bool varies) {
  llvm::Type* const pointer = e_.ir.getPtrTy();
  llvm::Value* const call =
      e_.slot(llvm::ArrayType::get(e_.ir.getInt8Ty(), sizeof(AerosolHostCall)), "host.call", alignof(AerosolHostCall));
  const auto set = [&](std::size_t offset, llvm::Value* value) {
    e_.ir.CreateStore(value, e_.pointerAt(call, offset));
  };
  set(offsetof(AerosolHostCall, arguments), frame_.arguments());
  set(offsetof(AerosolHostCall, values), values);
  set(offsetof(AerosolHostCall, high), high ? high : e_.zero(pointer));
  set(offsetof(AerosolHostCall, site), e_.ir.getInt32(addHostSite(instruction)));
  set(offsetof(AerosolHostCall, points), frame_.list());
  set(offsetof(AerosolHostCall, first), frame_.base());
  set(offsetof(AerosolHostCall, lanes), e_.ir.getInt32(varies ? e_.width() : 1));
  set(offsetof(AerosolHostCall, active), e_.bits(mask().may));
  auto* const type = llvm::FunctionType::get(e_.ir.getVoidTy(), {pointer, pointer}, false);
  llvm::Value* const service = hostService(e_, frame_.context(), offsetof(AerosolHostServices, call));
  e_.ir.CreateCall(type, service, {frame_.context(), call})->setDoesNotThrow();
}

void Lowering::emitHostCall(const Instruction& instruction) {
  if (domain_.splitsMasks()) return hasRange(instruction) ? emitRangeCall(instruction) : widenResults(instruction);
  const lang::FunctionUse& function = program_.functions[instruction.function];
  bool varies = !function.dependsOnArgumentsAlone();
  for (const lang::VariableId argument : instruction.arguments) varies = varies || variables_.isVarying(argument);
  if (function.native && function.native->bitcode) return emitNativeCall(instruction, varies);

  llvm::SmallVector<llvm::Value*, 8> values;
  const bool hasResult = instruction.result != lang::noVariable;
  const llvm::ArrayRef<Kind> resultKinds = hasResult ? variables_.kinds(instruction.result) : llvm::ArrayRef<Kind>();
  if (hasResult) {
    Value zeros;
    for (const Kind kind : resultKinds) zeros.push_back(variables_.zero(kind));
    values.push_back(argumentMemory(zeros, varies));
  }
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) values.push_back(hostArgument(instruction, i, varies));
  callHostService(instruction, pointerTable(values), nullptr, varies);

  if (hasResult) write(instruction, instruction.result, loadValue(values[0], resultKinds, varies));
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    if (!lang::writesArgument(program_, instruction, i)) continue;
    const lang::VariableId argument = instruction.arguments[i];
    llvm::Value* const memory = values[i + (hasResult ? 1 : 0)];
    if (!variables_.isArray(argument)) {
      write(instruction, argument, loadValue(memory, variables_.kinds(argument), varies));
      continue;
    }
    // The host writes active lanes only, and most often into the array itself.
    const ArrayMemory array = variables_.array(argument);
    if (array.base != memory) copyElements(array, {memory, array.element, array.length, varies}, nullptr);
  }
}

/// Over boxes of points nothing is known of what the host gives.
void Lowering::widenResults(const Instruction& instruction) {
  interface_.dependsOnHost = true;
  const auto widen = [&](lang::VariableId variable) {
    if (variables_.isArray(variable)) return variables_.widen(variable, mask());
    Value anything;
    for (const Kind kind : variables_.kinds(variable)) anything.push_back(domain_.anything(kind));
    write(instruction, variable, anything);
  };
  if (instruction.result != lang::noVariable) widen(instruction.result);
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    if (lang::writesArgument(program_, instruction, i)) widen(instruction.arguments[i]);
  }
}

}  // namespace aerosol::jit

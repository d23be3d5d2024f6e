// Adds variables and instructions to a program behind the lowering.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/lang/builtins.h"
#include "core/lang/fold.h"
#include "core/lang/program.h"

namespace aerosol::lang {

class CodeWriter {
 public:
  explicit CodeWriter(Program& program) : program_(program) {}

  /// Where instructions go from now on, and what was so before.
  Code* writeTo(Code* code) { return std::exchange(out_, code); }
  void setLocation(std::uint32_t location) { location_ = location; }
  Program& program() { return program_; }

  VariableId add(const Type& type, Storage storage, std::string name) {
    Variable variable;
    variable.type = type;
    variable.storage = storage;
    variable.name = std::move(name);
    variable.location = location_;
    program_.variables.push_back(std::move(variable));
    return static_cast<VariableId>(program_.variables.size() - 1);
  }

  VariableId constant(const Constant& value) {
    for (const VariableId known : constants_) {
      const Variable& variable = program_.variables[known];
      if (sameBits({variable.type, variable.value}, value)) return known;
    }
    const VariableId id = add(value.type, Storage::constant, "");
    program_.variables[id].value = value.value;
    constants_.push_back(id);
    return id;
  }
  VariableId number(float value) { return constant(Constant::ofFloat(value)); }
  VariableId grey(float value) { return constant({types::color, std::vector<float>(3, value)}); }
  VariableId zeroOf(VariableId other) { return constant(zeroConstant(program_.variables[other].type)); }

  bool isGrey(VariableId id, float value) const {
    const Variable& variable = program_.variables[id];
    return variable.storage == Storage::constant && variable.type == types::color &&
           sameBits({variable.type, variable.value}, {types::color, std::vector<float>(3, value)});
  }
  bool isMutable(VariableId id) const {
    const Storage storage = program_.variables[id].storage;
    return storage != Storage::constant && storage != Storage::temporary;
  }

  Instruction& append(Op op, VariableId result, std::vector<VariableId> arguments) {
    Instruction instruction;
    instruction.op = op;
    instruction.location = location_;
    instruction.result = result;
    instruction.arguments = std::move(arguments);
    out_->push_back(std::move(instruction));
    return out_->back();
  }
  VariableId emit(Op op, const Type& type, std::vector<VariableId> arguments) {
    const VariableId result = add(type, Storage::temporary, "");
    append(op, result, std::move(arguments));
    return result;
  }
  VariableId call(const char* base, std::vector<VariableId> arguments, const Type& type = types::floating) {
    std::vector<Type> types;
    for (const VariableId id : arguments) types.push_back(program_.variables[id].type);
    const std::string symbol = symbolOf(base, type, types);
    std::uint32_t function = 0;
    while (function < program_.functions.size() &&
           (program_.functions[function].host || program_.functions[function].symbol != symbol))
      ++function;
    if (function == program_.functions.size()) program_.functions.push_back({symbol, true, 0});
    const VariableId result = add(type, Storage::temporary, "");
    append(Op::call, result, std::move(arguments)).function = function;
    return result;
  }
  VariableId component(VariableId triple, int index) {
    return emit(Op::component, types::floating, {triple, constant(Constant::ofInt(index))});
  }
  /// The value as it is now.
  VariableId kept(VariableId id) { return isMutable(id) ? emit(Op::assign, program_.variables[id].type, {id}) : id; }

 private:
  Program& program_;
  std::vector<VariableId> constants_;
  Code* out_ = nullptr;
  std::uint32_t location_ = 0;
};

}  // namespace aerosol::lang

// isconstant: which values are the same for all points of an instance.
#include <algorithm>

#include "core/lang/analysis.h"
#include "core/lang/uniformity.h"

namespace aerosol::lang {

namespace {

bool isAsked(const Program& program, const Instruction& instruction) {
  return instruction.op == Op::call && program.functions[instruction.function].symbol == "isconstant";
}

VariableId addConstant(Program& program, std::int32_t value) {
  Variable variable;
  variable.type = types::integer;
  variable.storage = Storage::constant;
  variable.value = std::vector<std::int32_t>{value};
  program.variables.push_back(std::move(variable));
  return static_cast<VariableId>(program.variables.size() - 1);
}

}  // namespace

bool resolveConstancy(Program& program) {
  bool isUsed = false;
  forEachInstruction(program.body,
                     [&](const Instruction& instruction) { isUsed = isUsed || isAsked(program, instruction); });
  if (!isUsed) return false;
  Uniformity::Inputs inputs;
  inputs.startsVarying = [&](VariableId id) { return program.variables[id].storage == Storage::global; };
  inputs.callVaries = [&](const Instruction& instruction) {
    const FunctionUse& function = program.functions[instruction.function];
    // A named space may move with time.
    return function.symbol.starts_with("getmatrix_") || (function.host && !function.dependsOnArgumentsAlone());
  };
  const Uniformity uniformity(program, program.body, inputs);
  const VariableId no = addConstant(program, 0), yes = addConstant(program, 1);
  const auto resolve = [&](const auto& self, Code& code) -> void {
    for (Instruction& instruction : code) {
      if (isAsked(program, instruction)) {
        instruction.arguments = {uniformity.isVarying(instruction.arguments[0]) ? no : yes};
        instruction.op = Op::assign;
        instruction.function = 0;
      }
      for (Code& body : instruction.bodies) self(self, body);
    }
  };
  resolve(resolve, program.body);
  return true;
}

}  // namespace aerosol::lang

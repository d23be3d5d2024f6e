#include "core/lang/effects.h"

#include <algorithm>

#include "core/lang/analysis.h"
#include "core/lang/uniformity.h"

namespace aerosol::lang {

bool Effects::writesGlobals() const {
  return std::any_of(writes.begin(), writes.end(), [](bool written) { return written; });
}

Effects findEffects(const Program& program) {
  Effects effects;
  const auto mark = [&](std::array<bool, globalCount>& set, VariableId id) {
    if (id == noVariable) return;
    const Variable& variable = program.variables[id];
    if (variable.storage == Storage::global) set[static_cast<std::size_t>(variable.global)] = true;
  };
  forEachInstruction(program.body, [&](const Instruction& instruction) {
    effects.messages = effects.messages || instruction.op == Op::message;
    if (instruction.op == Op::call) {
      const FunctionUse& function = program.functions[instruction.function];
      if (!function.pure || (function.traits & (readsMessages | writesMessages)) != 0) effects.impureCalls = true;
    }
    for (std::size_t i = 0; i < instruction.arguments.size(); ++i)
      if (!writesArgument(program, instruction, i)) mark(effects.reads, instruction.arguments[i]);
    if (updatesResult(instruction.op)) mark(effects.reads, instruction.result);
    forEachWritten(program, instruction, [&](VariableId id) { mark(effects.writes, id); });
  });
  return effects;
}

}  // namespace aerosol::lang

#include "core/lang/analysis.h"

#include <algorithm>
#include <string_view>

namespace aerosol::lang {

Reads findReads(const Program& program) {
  Reads reads;
  reads.parameters.assign(program.parameters.size(), false);
  const auto read = [&](VariableId id) {
    if (id == noVariable) return;
    const Variable& variable = program.variables[id];
    if (variable.storage == Storage::global) reads.globals[static_cast<std::size_t>(variable.global)] = true;
    if (variable.storage == Storage::parameter) reads.parameters[variable.parameter] = true;
  };
  forEachInstruction(program.body, [&](const Instruction& instruction) {
    std::uint32_t outputs = 0;
    if (instruction.op == Op::call) {
      const FunctionUse& function = program.functions[instruction.function];
      outputs = function.outputs;
      reads.spaces = reads.spaces || std::string_view(function.symbol).starts_with("getmatrix_");
      reads.host = reads.host || (function.host && !function.dependsOnArgumentsAlone());
    }
    for (std::size_t i = 0; i < instruction.arguments.size(); ++i)
      if (i >= 32 || (outputs >> i & 1u) == 0) read(instruction.arguments[i]);
    // A partial write keeps the rest of what was there.
    if (updatesResult(instruction.op)) read(instruction.result);
  });
  for (const Output& output : program.outputs) read(output.variable);
  return reads;
}

bool isConstant(const Program& program, const Output& output) {
  const Reads reads = findReads(slice(program, {&output, 1}, Messages::drop));
  return !reads.spaces && !reads.host &&
         std::none_of(reads.globals.begin(), reads.globals.end(), [](bool read) { return read; });
}

}  // namespace aerosol::lang

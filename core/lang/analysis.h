// What can be known about a program without running it, and programs cut down to what is asked of them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

/// Whether a sliced program still leaves its messages (printf, warning, error).
enum class Messages : std::uint8_t { drop, keep };

/// The part of a program that the chosen outputs depend on (some of `program.outputs`, in the order given, which become
/// the outputs of the result). Instructions, variables and functions that are not needed are gone and indices
/// renumbered. `closureSites` and `parameters` keep all entries in order: a parameter that is not needed has `variable`
/// and `isSet` unset.
Program slice(const Program& program, std::span<const Output> outputs, Messages messages);

/// Values of parameters by index into `Program::parameters`. An empty value (monostate) means that no instance gives
/// one: the program computes the default.
using ParameterValues = std::map<std::uint32_t, ConstantValue>;

/// The program with some parameters fixed: constants are folded with the bits that the compiled program would compute
/// (library calls are not folded), copies are propagated, branches with known conditions are resolved. Outputs that
/// turn out constant name a constant variable.
Program specialise(const Program& program, const ParameterValues& values);

/// Replaces calls of `isconstant` by 1 where the argument is the same for all points of an instance, otherwise by 0.
/// True when there were some.
bool resolveConstancy(Program& program);

/// What the program reads from outside.
struct Reads {
  std::array<bool, globalCount> globals{};
  std::vector<bool> parameters;  ///< By index; its value or whether it is set.
  bool spaces = false;           ///< Named coordinate systems.
  bool host = false;             ///< What the host knows of a point: attributes, the ray's type, messages.

  bool any(Global global) const { return globals[static_cast<std::size_t>(global)]; }
};
Reads findReads(const Program& program);

/// Whether an output has one value for all points of an instance: it depends on parameters and constants alone. (After
/// `specialise`, because a branch on a parameter may hide a global.)
bool isConstant(const Program& program, const Output& output);

/// Calls `visit(const Instruction&)` for every instruction, before those of its bodies.
template <class Visit>
void forEachInstruction(const Code& code, Visit&& visit) {
  for (const Instruction& instruction : code) {
    visit(instruction);
    for (const Code& body : instruction.bodies) forEachInstruction(body, visit);
  }
}

/// Calls `visit(VariableId)` for every variable that the instruction itself writes (not its bodies).
template <class Visit>
void forEachWritten(const Program& program, const Instruction& instruction, Visit&& visit) {
  if (instruction.result != noVariable) visit(instruction.result);
  if (instruction.op != Op::call) return;
  const std::uint32_t outputs = program.functions[instruction.function].outputs;
  for (std::size_t i = 0; i < instruction.arguments.size() && i < 32; ++i)
    if ((outputs >> i & 1u) != 0) visit(instruction.arguments[i]);
}

/// Whether the operation reads its result before writing it (setComponent and its like).
inline bool updatesResult(Op op) {
  return op == Op::setComponent || op == Op::setMatrixElement || op == Op::setElement;
}

}  // namespace aerosol::lang

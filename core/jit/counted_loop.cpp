#include "core/jit/counted_loop.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/jit/cost.h"
#include "core/lang/analysis.h"
#include "core/lang/fold.h"

namespace aerosol::jit {

using lang::Instruction;
using lang::Op;
using lang::VariableId;

namespace {

/// Loops of no more rounds, and of no more cost in all, are written out.
constexpr unsigned writtenRounds = 64;
constexpr double writtenCost = 256;

bool hasLoop(const lang::Code& code) {
  bool found = false;
  lang::forEachInstruction(code, [&](const Instruction& instruction) { found = found || instruction.op == Op::loop; });
  return found;
}

std::optional<std::int64_t> constantInt(const lang::Program& program, VariableId id) {
  const lang::Variable& variable = program.variables[id];
  const auto* ints = std::get_if<std::vector<std::int32_t>>(&variable.value);
  if (variable.storage != lang::Storage::constant || !ints || ints->size() != 1) return std::nullopt;
  return (*ints)[0];
}

bool writes(const lang::Program& program, const Instruction& instruction, VariableId id) {
  bool found = false;
  const auto look = [&](const Instruction& one) {
    lang::forEachWritten(program, one, [&](VariableId written) { found = found || written == id; });
  };
  look(instruction);
  for (const lang::Code& body : instruction.bodies) lang::forEachInstruction(body, look);
  return found;
}
bool writes(const lang::Program& program, const lang::Code& code, VariableId id) {
  return std::ranges::any_of(code, [&](const Instruction& one) { return writes(program, one, id); });
}

/// What the counter holds when the loop begins.
std::optional<std::int64_t> startOf(const lang::Program& program, const lang::Code& code, const Instruction& loop,
                                    VariableId counter) {
  std::optional<std::int64_t> start;
  for (const Instruction& instruction : code) {
    if (&instruction == &loop) return start;
    if (!writes(program, instruction, counter)) continue;
    start = instruction.op == Op::assign ? constantInt(program, instruction.arguments[0]) : std::nullopt;
  }
  return std::nullopt;
}

/// What the step adds to the counter. (`i++` remembers the counter in a temporary first.)
std::optional<std::int64_t> stepOf(const lang::Program& program, const lang::Code& step, VariableId counter) {
  std::optional<std::int64_t> sum;
  VariableId copy = counter;
  for (const Instruction& instruction : step) {
    const bool copies = instruction.op == Op::assign && instruction.arguments[0] == counter && !sum;
    if (copies && program.variables[instruction.result].storage == lang::Storage::temporary) copy = instruction.result;
    if (!writes(program, instruction, counter)) continue;
    const bool adds = instruction.op == Op::add, subtracts = instruction.op == Op::subtract;
    if (sum || (!adds && !subtracts)) return std::nullopt;
    if (instruction.arguments[0] != counter && instruction.arguments[0] != copy) return std::nullopt;
    sum = constantInt(program, instruction.arguments[1]);
    if (!sum) return std::nullopt;
    if (subtracts) sum = -*sum;
  }
  return sum;
}

bool holds(Op comparison, std::int64_t a, std::int64_t b) {
  const auto left = lang::Constant::ofInt(static_cast<std::int32_t>(a));
  const auto right = lang::Constant::ofInt(static_cast<std::int32_t>(b));
  const std::array<const lang::Constant*, 2> operands = {&left, &right};
  return lang::foldOperation(comparison, lang::types::integer, operands)->asInt() != 0;
}

}  // namespace

std::optional<unsigned> countedRounds(const lang::Program& program, const lang::Code& code, const Instruction& loop,
                                      unsigned most) {
  if (loop.testsLast || loop.bodies[0].size() != 1) return std::nullopt;
  const Instruction& test = loop.bodies[0].front();
  const bool compares = (test.op >= Op::less && test.op <= Op::greaterEqual) || test.op == Op::notEqual;
  if (!compares || test.result != loop.arguments[0]) return std::nullopt;
  const VariableId counter = test.arguments[0];
  const auto last = constantInt(program, test.arguments[1]);
  if (!last || !(program.variables[counter].type == lang::types::integer) || writes(program, loop.bodies[1], counter))
    return std::nullopt;
  const auto start = startOf(program, code, loop, counter);
  const auto step = stepOf(program, loop.bodies[2], counter);
  if (!start || !step) return std::nullopt;
  unsigned rounds = 0;
  for (std::int64_t i = *start; holds(test.op, i, *last); i += *step)
    if (++rounds > most || i + *step != static_cast<std::int32_t>(i + *step)) return std::nullopt;
  return rounds;
}

bool isWrittenOut(const lang::Program& program, const lang::Code& code, const Instruction& loop) {
  if (hasLoop(loop.bodies[1])) return false;
  const auto rounds = countedRounds(program, code, loop, writtenRounds);
  return rounds && *rounds > 0 && *rounds * Cost(program).of(loop.bodies[1]) <= writtenCost;
}

}  // namespace aerosol::jit

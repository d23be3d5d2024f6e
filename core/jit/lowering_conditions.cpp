// What conditions tell of the numbers that they compare. Over a box `if (d > 0)` may hold at some points only; where it
// does, d is above 0 although its range over the whole box is not (Bourdoncle 1993: abstract interpretation's
// refinement by tests). Code under the condition then reads d cut to what the condition allows. Exact domains know all
// this already.
#include <algorithm>
#include <array>
#include <span>

#include "core/jit/lowering.h"
#include "core/lang/analysis.h"

namespace aerosol::jit {

using lang::Code;
using lang::Instruction;
using lang::Op;
using lang::VariableId;

namespace {

bool isTest(Op op) { return (op >= Op::less && op <= Op::logicalOr) || op == Op::logicalNot || op == Op::toBool; }

/// The code reads the variable, and does not write it.
bool onlyReads(const lang::Program& program, std::span<const Instruction> code, VariableId id) {
  bool reads = false, writes = false;
  const auto visit = [&](const Instruction& instruction) {
    lang::forEachWritten(program, instruction, [&](VariableId written) { writes = writes || written == id; });
    reads = reads || std::ranges::find(instruction.arguments, id) != instruction.arguments.end();
  };
  for (const Instruction& instruction : code) {
    visit(instruction);
    for (const Code& body : instruction.bodies) lang::forEachInstruction(body, visit);
  }
  return reads && !writes;
}

bool alwaysExits(const Code& code) { return !code.empty() && lang::isExit(code.back().op); }

}  // namespace

const Instruction* Lowering::innermostLoop() const {
  const auto it = std::find_if(targets_.rbegin(), targets_.rend(),
                               [](const Target& target) { return target.instruction->op == Op::loop; });
  return it == targets_.rend() ? nullptr : it->instruction;
}

void Lowering::rememberTest(const Instruction& instruction) {
  if (!domain_.splitsMasks()) return;
  if (instruction.op == Op::component) return rememberPart(instruction);
  if (instruction.op == Op::assign) return rememberFlag(instruction);
  const bool isTemporary = program_.variables[instruction.result].storage == lang::Storage::temporary;
  if (!isTemporary) tests_.erase(instruction.result);
  if (!isTest(instruction.op) ||
      std::ranges::find(instruction.arguments, instruction.result) != instruction.arguments.end())
    return;
  Test test{&instruction, innermostLoop(), {}};
  for (const VariableId argument : instruction.arguments) test.writes.push_back(variables_.writesSoFar(argument));
  if (!isTemporary) {
    test.code = codes_.back();
    test.ownWrites = variables_.writesSoFar(instruction.result);
  }
  tests_.insert_or_assign(instruction.result, std::move(test));
}

/// A variable that holds what a test gave. Lanes only ever leave a list of code: those that come to a place in it, or
/// in what it holds, have all been at the places before.
void Lowering::rememberFlag(const Instruction& instruction) {
  tests_.erase(instruction.result);
  const auto known = tests_.find(instruction.arguments[0]);
  if (known == tests_.end() || known->second.loop != innermostLoop()) return;
  Test flag = known->second;
  flag.code = codes_.back();
  flag.ownWrites = variables_.writesSoFar(instruction.result);
  tests_.insert_or_assign(instruction.result, std::move(flag));
}

void Lowering::rememberPart(const Instruction& instruction) {
  if (program_.variables[instruction.result].storage != lang::Storage::temporary) return;
  const VariableId whole = instruction.arguments[0];
  const Number index = number(instruction.arguments[1]);
  const auto* constant = index.varying ? nullptr : llvm::dyn_cast<llvm::ConstantInt>(index.parts[0]);
  if (!constant || !constant->getValue().ult(3)) return;
  parts_.insert_or_assign(instruction.result, Part{whole, static_cast<unsigned>(constant->getZExtValue()),
                                                   innermostLoop(), variables_.writesSoFar(whole)});
}

/// The triple that a number is a component of, if it still is.
const Lowering::Part* Lowering::partOf(VariableId id) const {
  const auto found = parts_.find(id);
  if (found == parts_.end() || found->second.loop != innermostLoop()) return nullptr;
  return variables_.writesSoFar(found->second.whole) == found->second.writes ? &found->second : nullptr;
}

/// Cuts the variables that the condition compares to what they can be where it holds, or where it does not, as far as
/// they `concern` what follows. Those that are cut are added to `cut`.
void Lowering::learn(VariableId condition, bool holds, llvm::function_ref<bool(VariableId)> concerns,
                     std::vector<VariableId>& cut) {
  const auto found = tests_.find(condition);
  // The test was made in the same round of the same loop, so that what it compared is what there is now.
  if (found == tests_.end() || found->second.loop != innermostLoop()) return;
  const Test test = found->second;
  if (test.code &&
      (variables_.writesSoFar(condition) != test.ownWrites || std::ranges::find(codes_, test.code) == codes_.end()))
    return;
  const std::vector<VariableId>& arguments = test.instruction->arguments;
  const auto isUnchanged = [&](std::size_t i) {
    return !variables_.isArray(arguments[i]) && variables_.writesSoFar(arguments[i]) == test.writes[i];
  };
  const Op op = test.instruction->op;
  if (op == Op::logicalNot || op == Op::toBool) {
    if (isUnchanged(0)) learn(arguments[0], holds == (op == Op::toBool), concerns, cut);
    return;
  }
  if (op == Op::logicalAnd || op == Op::logicalOr) {
    if (holds != (op == Op::logicalAnd)) return;
    for (std::size_t i = 0; i < arguments.size(); ++i)
      if (isUnchanged(i)) learn(arguments[i], holds, concerns, cut);
    return;
  }
  if (isUnchanged(0) && isUnchanged(1)) learnComparison(*test.instruction, holds, concerns, cut);
}

/// A relation that does not hold is the opposite one, or one of the two is no number.
void Lowering::learnComparison(const Instruction& test, bool holds, llvm::function_ref<bool(VariableId)> concerns,
                               std::vector<VariableId>& cut) {
  const bool isEquality = test.op == Op::equal || test.op == Op::notEqual;
  if (isEquality && holds != (test.op == Op::equal)) return;
  const bool isLess = test.op == Op::less || test.op == Op::lessEqual;
  const std::array<Value, 2> sides = {variables_.read(test.arguments[0]), variables_.read(test.arguments[1])};
  if (sides[0].size() != 1 || sides[1].size() != 1 || sides[0][0].kind == Kind::string) return;
  const bool isOrdered = holds || isEquality;
  for (std::size_t i = 0; i < 2; ++i) {
    const VariableId id = test.arguments[i];
    const Number x = sides[i][0];
    Number limit = sides[1 - i][0];
    const Part* const part = partOf(id);
    const bool concernsWhole = part && concerns(part->whole);
    if (!x.varying || (!concernsWhole && !concerns(id))) continue;
    if (x.kind == Kind::integer && limit.kind == Kind::floating) continue;
    if (limit.kind == Kind::integer && x.kind == Kind::floating) limit = unary(Op::toFloat, limit);
    limit = domain_.varying(limit);
    const bool isBelow = isEquality || (isLess == holds) == (i == 0);
    const auto limited = [&](Number number) {
      if (isBelow) number = domain_.limited(number, limit, true, isOrdered);
      if (!isBelow || isEquality) number = domain_.limited(number, limit, false, isOrdered);
      return number;
    };
    if (concerns(id)) {
      variables_.narrow(id, {limited(x)});
      cut.push_back(id);
    }
    if (concernsWhole) {
      const VariableId whole = part->whole;
      Value triple = variables_.read(whole);
      if (!triple[part->index].varying) continue;
      triple[part->index] = limited(triple[part->index]);
      variables_.narrow(whole, std::move(triple));
      cut.push_back(whole);
    }
  }
}

void Lowering::forget(const std::vector<VariableId>& cut) {
  for (const VariableId id : cut) variables_.endNarrow(id);
}

/// Emits the code of a branch's side.
void Lowering::emitUnder(const Instruction& branch, bool holds) {
  const Code& code = branch.bodies[holds ? 0 : 1];
  std::vector<VariableId> cut;
  if (domain_.splitsMasks())
    learn(branch.arguments[0], holds, [&](VariableId id) { return onlyReads(program_, code, id); }, cut);
  emit(code);
  forget(cut);
}

/// Behind a branch one of whose sides always leaves: the other one is where lanes come from.
void Lowering::learnFromExit(const Instruction& branch, std::span<const Instruction> rest,
                             std::vector<VariableId>& cut) {
  if (!domain_.splitsMasks() || branch.op != Op::branch) return;
  const bool exits[2] = {alwaysExits(branch.bodies[0]), alwaysExits(branch.bodies[1])};
  if (exits[0] == exits[1]) return;
  learn(branch.arguments[0], exits[1], [&](VariableId id) { return onlyReads(program_, rest, id); }, cut);
}

/// An operand of a choice, where the condition chooses it.
Value Lowering::readUnder(VariableId condition, bool holds, VariableId operand) {
  std::vector<VariableId> cut;
  if (domain_.splitsMasks()) learn(condition, holds, [operand](VariableId id) { return id == operand; }, cut);
  const Value value = variables_.read(operand);
  forget(cut);
  return value;
}

}  // namespace aerosol::jit

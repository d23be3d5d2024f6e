#include "core/jit/lowering.h"

#include <algorithm>
#include <cassert>
#include <span>

namespace aerosol::jit {

using lang::Code;
using lang::Instruction;
using lang::Op;

namespace {

/// Code that costs no more is run for no lane rather than branched around.
constexpr double skipThreshold = 12;

bool isTarget(const Instruction& construct, const Instruction& exit) {
  if (exit.op == Op::leave) return construct.op == Op::scope && construct.scopeId == exit.scopeId;
  return construct.op == Op::loop;
}

bool hasExits(const Code& code) {
  return std::any_of(code.begin(), code.end(), [](const Instruction& instruction) {
    return lang::isExit(instruction.op) || std::ranges::any_of(instruction.bodies, hasExits);
  });
}

bool mustBeSkipped(const lang::Program& program, std::span<const Instruction> code) {
  return std::any_of(code.begin(), code.end(), [&](const Instruction& instruction) {
    if (instruction.op == Op::loop || instruction.op == Op::message) return true;
    if (instruction.op == Op::call) {
      const lang::FunctionUse& function = program.functions[instruction.function];
      if (!function.pure || function.host) return true;
    }
    return std::any_of(instruction.bodies.begin(), instruction.bodies.end(),
                       [&](const Code& body) { return mustBeSkipped(program, body); });
  });
}

}  // namespace

Lowering::Lowering(Emitter& emitter, NumberDomain& domain, KernelFrame& frame, Variables& variables,
                   const lang::Program& program, const lang::Uniformity& uniformity, KernelInterface& interface,
                   LoweringOptions options)
    : e_(emitter),
      domain_(domain),
      frame_(frame),
      variables_(variables),
      program_(program),
      uniformity_(uniformity),
      interface_(interface),
      options_(options),
      cost_(program) {
  std::vector<const Instruction*> enclosing;
  findExits(program.body, enclosing);
}

void Lowering::run() {
  may_ = maskSlot("mask");
  if (domain_.splitsMasks()) must_ = maskSlot("mask.must");
  setMask(frame_.active());
  if (options_.leftOut) {
    stopped_ = maskSlot("stopped");
    e_.ir.CreateStore(e_.noLanes(), stopped_);
  }
  emit(program_.body);
}

llvm::Value* Lowering::stopped() {
  return stopped_ ? static_cast<llvm::Value*>(e_.ir.CreateLoad(e_.maskType(), stopped_)) : e_.noLanes();
}

bool Lowering::isLeftOut(const Instruction& branch, DearPart::Place place) const {
  return options_.leftOut && options_.leftOut->branch == &branch && options_.leftOut->place == place;
}

void Lowering::findExits(const Code& code, std::vector<const Instruction*>& enclosing) {
  for (const Instruction& instruction : code) {
    if (lang::isExit(instruction.op) && uniformity_.isMasked(instruction)) {
      auto it = enclosing.rbegin();
      for (; it != enclosing.rend() && !isTarget(**it, instruction); ++it) exits_[*it].passing = true;
      if (it == enclosing.rend()) continue;
      (instruction.op == Op::continueLoop ? exits_[*it].continued : exits_[*it].left) = true;
    }
    enclosing.push_back(&instruction);
    for (const Code& body : instruction.bodies) findExits(body, enclosing);
    enclosing.pop_back();
  }
}

Lowering::Exits Lowering::exitsOf(const Instruction& control) const {
  const auto it = exits_.find(&control);
  return it == exits_.end() ? Exits{} : it->second;
}

// --- masks

llvm::AllocaInst* Lowering::maskSlot(const char* name) { return e_.slot(e_.maskType(), name); }

Mask Lowering::mask() {
  llvm::Value* const may = e_.ir.CreateLoad(e_.maskType(), may_);
  return {may, must_ ? e_.ir.CreateLoad(e_.maskType(), must_) : may};
}

void Lowering::setMask(const Mask& mask) {
  e_.ir.CreateStore(mask.may, may_);
  if (must_) e_.ir.CreateStore(mask.must, must_);
}

void Lowering::addLanes(llvm::AllocaInst* slot, llvm::Value* lanes) {
  e_.ir.CreateStore(e_.ir.CreateOr(e_.ir.CreateLoad(e_.maskType(), slot), lanes), slot);
}

/// Lanes that surely are where several ways join: those that surely were at the beginning, without those that may wait
/// for an end further out. (At a loop's step those that continued have come back.)
llvm::Value* Lowering::mustAfter(llvm::Value* mustBefore, llvm::Value* may, bool atStep) {
  if (!domain_.splitsMasks()) return may;
  llvm::Value* must = mustBefore;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const bool isOwn = atStep && i + 1 == targets_.size();
    for (llvm::AllocaInst* const waiting : {targets_[i].left, isOwn ? nullptr : targets_[i].continued}) {
      if (waiting) must = e_.without(must, e_.ir.CreateLoad(e_.maskType(), waiting));
    }
  }
  return must;
}

// --- blocks

void Lowering::emit(const Code& code, bool maySkip) {
  llvm::BasicBlock* end = nullptr;
  std::vector<lang::VariableId> cut;
  codes_.push_back(&code);
  countSegment(code, 0);
  for (std::size_t i = 0; i < code.size(); ++i) {
    const Instruction& instruction = code[i];
    emit(instruction);
    if (lang::isExit(instruction.op)) break;  // nothing comes here
    if (isLeftOut(instruction, DearPart::Place::behind)) {
      e_.ir.CreateStore(mask().may, stopped_);
      setMask({e_.noLanes(), e_.noLanes()});
      break;
    }
    if (i + 1 == code.size() || !exitsOf(instruction).passing) continue;
    const std::span<const Instruction> rest = std::span(code).subspan(i + 1);
    if (maySkip && (cost_.of(rest) > skipThreshold || mustBeSkipped(program_, rest))) {
      if (!end) end = e_.block("skipped");
      llvm::BasicBlock* const remaining = e_.block("remaining");
      e_.ir.CreateCondBr(e_.any(mask().may), remaining, end);
      e_.ir.SetInsertPoint(remaining);
    }
    countSegment(code, i + 1);
    learnFromExit(instruction, rest, cut);
  }
  forget(cut);
  codes_.pop_back();
  if (end) e_.enter(end);
}

/// Counts the instructions from `begin` to the next one after which lanes may be missing.
void Lowering::countSegment(const Code& code, std::size_t begin) {
  if (!options_.counters) return;
  std::size_t end = begin;
  while (end < code.size() && !(end > begin && exitsOf(code[end - 1]).passing)) ++end;
  frame_.count(static_cast<unsigned>(cost_.withoutBodies(std::span(code).subspan(begin, end - begin))), mask());
}

void Lowering::emit(const Instruction& instruction) {
  switch (instruction.op) {
    case Op::branch:
      return emitBranch(instruction);
    case Op::loop:
      return emitLoop(instruction);
    case Op::scope:
      return emitScope(instruction);
    case Op::breakLoop:
    case Op::continueLoop:
    case Op::leave:
      return emitExit(instruction);
    case Op::call:
      return emitCall(instruction);
    case Op::message:
      return emitMessage(instruction);
    default:
      return emitOperation(instruction);
  }
}

// --- branches

void Lowering::emitBranch(const Instruction& instruction) {
  const Number condition = number(instruction.arguments[0]);
  if (condition.varying) {
    emitMaskedSides(instruction, condition);
  } else {
    emitSides(instruction, domain_.scalars().isTrue(condition.parts[0]));
  }
}

/// All lanes go one way.
void Lowering::emitSides(const Instruction& instruction, llvm::Value* condition) {
  if (const auto* known = llvm::dyn_cast<llvm::ConstantInt>(condition)) {
    emit(instruction.bodies[known->isZero() ? 1 : 0]);
    return;
  }
  const Sometimes nested(variables_);
  llvm::BasicBlock* const yes = e_.block("yes");
  llvm::BasicBlock* const no = e_.block("no");
  llvm::BasicBlock* const end = e_.block("joined");
  e_.ir.CreateCondBr(condition, yes, no);
  e_.ir.SetInsertPoint(yes);
  emit(instruction.bodies[0]);
  e_.enter(end);
  e_.ir.SetInsertPoint(no);
  emit(instruction.bodies[1]);
  e_.enter(end);
}

void Lowering::emitMaskedSides(const Instruction& instruction, const Number& condition) {
  const Mask before = mask();
  const Condition split = domain_.condition(condition);
  const Mask whenTrue = domain_.narrow(before, split);
  const Mask whenFalse = domain_.narrowNot(before, split);
  const bool leavesTrue = isLeftOut(instruction, DearPart::Place::whenTrue);
  if (leavesTrue || isLeftOut(instruction, DearPart::Place::whenFalse)) {
    e_.ir.CreateStore((leavesTrue ? whenTrue : whenFalse).may, stopped_);
    const Mask& other = leavesTrue ? whenFalse : whenTrue;
    llvm::Value* const through = emitMaskedSide(instruction, !leavesTrue, other);
    setMask({through, through});
    return;
  }
  const bool passing = exitsOf(instruction).passing;
  llvm::Value* const yes = emitMaskedSide(instruction, true, whenTrue);
  llvm::Value* const no = emitMaskedSide(instruction, false, whenFalse);
  if (!passing) {
    setMask(before);
    return;
  }
  llvm::Value* const may = e_.ir.CreateOr(yes, no);
  setMask({may, mustAfter(before.must, may)});
}

/// Gives the lanes that come out at the end.
llvm::Value* Lowering::emitMaskedSide(const Instruction& branch, bool holds, const Mask& mask) {
  const Code& code = branch.bodies[holds ? 0 : 1];
  const bool passing = exitsOf(branch).passing;
  const Sometimes nested(variables_);
  if (code.empty()) return mask.may;
  if (cost_.of(code) <= skipThreshold && !mustBeSkipped(program_, code)) {
    setMask(mask);
    emitUnder(branch, holds);
    return passing ? this->mask().may : mask.may;
  }
  llvm::BasicBlock* const side = e_.block("side");
  llvm::BasicBlock* const end = e_.block("side.end");
  llvm::AllocaInst* const remaining = passing ? maskSlot("remaining") : nullptr;
  if (remaining) e_.ir.CreateStore(mask.may, remaining);
  e_.ir.CreateCondBr(e_.any(mask.may), side, end);
  e_.ir.SetInsertPoint(side);
  setMask(mask);
  emitUnder(branch, holds);
  if (remaining) e_.ir.CreateStore(this->mask().may, remaining);
  e_.enter(end);
  return remaining ? e_.ir.CreateLoad(e_.maskType(), remaining) : mask.may;
}

// --- scopes and exits

void Lowering::emitScope(const Instruction& instruction) {
  Target target{&instruction, e_.block("scope.end")};
  const Mask before = mask();
  if (exitsOf(instruction).left) {
    target.left = maskSlot("left");
    e_.ir.CreateStore(e_.noLanes(), target.left);
  }
  targets_.push_back(target);
  std::optional<Sometimes> nested;
  if (hasExits(instruction.bodies[0])) nested.emplace(variables_);
  emit(instruction.bodies[0]);
  nested.reset();
  e_.enter(target.end);
  emitTargetEnd(before);
}

/// Lanes that left join those that came through. Ends the innermost target.
void Lowering::emitTargetEnd(const Mask& before) {
  const Target target = targets_.back();
  targets_.pop_back();
  if (!target.left) return;
  llvm::Value* const may = e_.ir.CreateOr(mask().may, e_.ir.CreateLoad(e_.maskType(), target.left));
  setMask({may, mustAfter(before.must, may)});
}

Lowering::Target& Lowering::targetOf(const Instruction& exit) {
  const auto it = std::find_if(targets_.rbegin(), targets_.rend(),
                               [&](const Target& target) { return isTarget(*target.instruction, exit); });
  assert(it != targets_.rend());
  return *it;
}

void Lowering::emitExit(const Instruction& instruction) {
  const Target& target = targetOf(instruction);
  if (uniformity_.isMasked(instruction)) {
    addLanes(instruction.op == Op::continueLoop ? target.continued : target.left, mask().may);
    setMask({e_.noLanes(), e_.noLanes()});
    return;
  }
  e_.ir.CreateBr(instruction.op == Op::continueLoop ? target.step : target.end);
  e_.ir.SetInsertPoint(e_.block("unreachable"));
}

}  // namespace aerosol::jit

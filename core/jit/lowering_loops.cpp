// Loops: rounds under shrinking masks, and the budget that stops endless ones.
#include <algorithm>
#include <limits>

#include "core/jit/counted_loop.h"
#include "core/jit/lowering.h"
#include "core/lang/analysis.h"

namespace aerosol::jit {

using lang::Instruction;
using lang::Op;

namespace {

/// Bounds that a loop has not settled after so many rounds are given up.
constexpr std::uint32_t roundsBeforeWidening = 512;

}  // namespace

void Lowering::emitLoop(const Instruction& instruction) {
  const Sometimes nested(variables_);
  const Mask before = mask();
  const Exits exits = exitsOf(instruction);
  Target target{&instruction, e_.block("loop.end"), e_.block("loop.step")};
  if (uniformity_.isVarying(instruction) || exits.left || !uniformity_.countsAlike(instruction)) {
    target.left = maskSlot("left");
    e_.ir.CreateStore(e_.noLanes(), target.left);
  }
  if (exits.continued) target.continued = maskSlot("continued");
  targets_.push_back(target);
  const RoundCounter counter = makeRoundCounter(instruction);
  llvm::BasicBlock* const test = e_.block("loop.test");
  llvm::BasicBlock* const body = e_.block("loop.body");
  if (instruction.testsLast) {
    e_.enter(body);
    emitLoopBody(instruction, test, counter);
    e_.ir.SetInsertPoint(test);
    emitLoopTest(instruction, body);
  } else {
    e_.enter(test);
    emitLoopTest(instruction, body);
    e_.ir.SetInsertPoint(body);
    emitLoopBody(instruction, test, counter);
    if (isUnrolled(instruction)) unroll(e_.ir.GetInsertBlock());
  }
  e_.ir.SetInsertPoint(target.end);
  emitTargetEnd(before);
}

void Lowering::emitLoopTest(const Instruction& instruction, llvm::BasicBlock* body) {
  const Target target = targets_.back();
  emit(instruction.bodies[0], false);
  const Number condition = number(instruction.arguments[0]);
  if (!condition.varying) {
    e_.ir.CreateCondBr(domain_.scalars().isTrue(condition.parts[0]), body, target.end);
    return;
  }
  const Mask before = mask();
  const Condition split = domain_.condition(condition);
  const Mask staying = domain_.narrow(before, split);
  addLanes(target.left, domain_.narrowNot(before, split).may);
  setMask(staying);
  e_.ir.CreateCondBr(e_.any(staying.may), body, target.end);
}

/// The body and the step, then on to `next`.
void Lowering::emitLoopBody(const Instruction& instruction, llvm::BasicBlock* next, const RoundCounter& counter) {
  const Target target = targets_.back();
  emitRoundCount(instruction, counter);
  const Mask before = mask();
  if (target.continued) e_.ir.CreateStore(e_.noLanes(), target.continued);
  emit(instruction.bodies[1]);
  e_.enter(target.step);
  if (target.continued) {
    llvm::Value* const may = e_.ir.CreateOr(mask().may, e_.ir.CreateLoad(e_.maskType(), target.continued));
    setMask({may, mustAfter(before.must, may, true)});
  }
  const Exits exits = exitsOf(instruction);
  if (exits.left || exits.passing) {
    llvm::BasicBlock* const remaining = e_.block("loop.remaining");
    e_.ir.CreateCondBr(e_.any(mask().may), remaining, target.end);
    e_.ir.SetInsertPoint(remaining);
  }
  emit(instruction.bodies[2]);
  e_.ir.CreateBr(next);
}

bool Lowering::isUnrolled(const Instruction& instruction) const {
  return !domain_.widensAtBudget() && isWrittenOut(program_, *codes_.back(), instruction);
}

/// Asks for the loop that ends in this block to be written out.
void Lowering::unroll(llvm::BasicBlock* latch) {
  llvm::MDNode* const full =
      llvm::MDNode::get(e_.context(), llvm::MDString::get(e_.context(), "llvm.loop.unroll.full"));
  llvm::MDNode* const id = llvm::MDNode::getDistinct(e_.context(), {nullptr, full});
  id->replaceOperandWith(0, id);
  latch->getTerminator()->setMetadata(llvm::LLVMContext::MD_loop, id);
}

Lowering::RoundCounter Lowering::makeRoundCounter(const Instruction& instruction) {
  RoundCounter counter;
  counter.rounds = e_.slot(e_.ir.getInt32Ty(), "rounds");
  if (!uniformity_.countsAlike(instruction)) counter.lanes = e_.slot(e_.laneType(Kind::integer), "rounds.lanes");
  frame_.atChunkStart([&] {
    e_.ir.CreateStore(e_.ir.getInt32(0), counter.rounds);
    if (counter.lanes) e_.ir.CreateStore(e_.zero(e_.laneType(Kind::integer)), counter.lanes);
  });
  return counter;
}

/// A lane's rounds are counted exactly, but looked at only once the rounds of all lanes together exceed the budget.
void Lowering::emitRoundCount(const Instruction& instruction, const RoundCounter& counter) {
  llvm::Value* budget = frame_.loopBudget();
  if (counter.lanes && domain_.widensAtBudget()) {
    budget = frame_.atEntry([&] {
      return e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::umin, budget, e_.ir.getInt32(roundsBeforeWidening));
    });
  }
  llvm::Type* const type = e_.ir.getInt32Ty();
  llvm::Value* const rounds = e_.ir.CreateAdd(e_.ir.CreateLoad(type, counter.rounds), e_.ir.getInt32(1));
  e_.ir.CreateStore(rounds, counter.rounds);
  if (counter.lanes) {
    llvm::Value* const lanes = e_.ir.CreateLoad(e_.laneType(Kind::integer), counter.lanes);
    e_.ir.CreateStore(e_.ir.CreateSub(lanes, e_.ir.CreateSExt(mask().may, lanes->getType())), counter.lanes);
  }
  llvm::BasicBlock* const check = e_.block("loop.check");
  llvm::BasicBlock* const goOn = e_.block("loop.go");
  llvm::MDNode* const unlikely =
      llvm::MDBuilder(e_.context()).createBranchWeights(1, std::numeric_limits<std::uint32_t>::max() / 2);
  e_.ir.CreateCondBr(e_.ir.CreateICmpUGT(rounds, budget), check, goOn, unlikely);
  e_.ir.SetInsertPoint(check);
  emitOutOfBudget(instruction, counter, budget, goOn);
  e_.ir.SetInsertPoint(goOn);
}

void Lowering::emitOutOfBudget(const Instruction& instruction, const RoundCounter& counter, llvm::Value* budget,
                               llvm::BasicBlock* goOn) {
  const Target target = targets_.back();
  const Mask before = mask();
  if (!counter.lanes) {
    reportBudget(instruction, before.may);
    e_.ir.CreateBr(target.end);
    return;
  }
  llvm::Value* const lanes = e_.ir.CreateLoad(e_.laneType(Kind::integer), counter.lanes);
  llvm::Value* const over = e_.both(before.may, e_.ir.CreateICmpUGT(lanes, e_.splat(budget)));
  if (domain_.widensAtBudget()) {
    widenWritten(instruction.bodies[0], {over, e_.noLanes()});
    widenWritten(instruction.bodies[1], {over, e_.noLanes()});
    widenWritten(instruction.bodies[2], {over, e_.noLanes()});
  }
  reportBudget(instruction, over);
  addLanes(target.left, over);
  setMask({e_.without(before.may, over), e_.without(before.must, over)});
  e_.ir.CreateCondBr(e_.any(mask().may), goOn, target.end);
}

void Lowering::reportBudget(const Instruction& instruction, llvm::Value* lanes) {
  report(AEROSOL_REPORT_BUDGET, instruction.location, {}, {}, {}, lanes);
}

/// What later rounds would have done to the lanes: any value in what they write, and any of the exits in them.
void Lowering::widenWritten(const lang::Code& code, const Mask& lanes) {
  for (const Instruction& instruction : code) {
    lang::forEachWritten(program_, instruction, [&](lang::VariableId id) { variables_.widen(id, lanes); });
    for (const lang::Code& body : instruction.bodies) widenWritten(body, lanes);
    if (!lang::isExit(instruction.op) || instruction.op == Op::continueLoop) continue;
    for (const Target& target : targets_) {
      const bool isIt = instruction.op == Op::leave && target.instruction->op == Op::scope &&
                        target.instruction->scopeId == instruction.scopeId;
      if (isIt && target.left) addLanes(target.left, lanes.may);
    }
  }
}

}  // namespace aerosol::jit

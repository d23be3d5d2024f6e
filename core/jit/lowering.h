// A program's structured code to IR, over any number domain.
#pragma once

#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/jit/cost.h"
#include "core/jit/dear_part.h"
#include "core/jit/kernel_frame.h"
#include "core/jit/variables.h"
#include "core/lang/program.h"
#include "core/lang/uniformity.h"

namespace aerosol::jit {

struct LoweringOptions {
  bool counters = false;
  bool reports = true;              ///< Of array indices and loop budgets. (Messages are in the program or not.)
  std::optional<DearPart> leftOut;  ///< Lanes that come to it go no further.
};

/// Walks the code under a mask of lanes. Where all points that run it go the same way control flow becomes branches;
/// where they part, both sides run one after the other, each under its mask and skipped when no lane is left for it
/// (short sides are not worth the test). Lanes that leave a loop or scope early wait in a mask of their own for its
/// end.
class Lowering {
 public:
  Lowering(Emitter& emitter, NumberDomain& domain, KernelFrame& frame, Variables& variables,
           const lang::Program& program, const lang::Uniformity& uniformity, KernelInterface& interface,
           LoweringOptions options);

  void run();
  /// When run: the active lanes that came to the part that is left out.
  llvm::Value* stopped();

 private:
  /// A loop or scope that is being emitted.
  struct Target {
    const lang::Instruction* instruction = nullptr;
    llvm::BasicBlock* end = nullptr;
    llvm::BasicBlock* step = nullptr;
    llvm::AllocaInst* left = nullptr;       ///< Lanes that wait for the end; null when none can.
    llvm::AllocaInst* continued = nullptr;  ///< Lanes that wait for the step.
  };
  /// Counts the rounds of a loop statement against the budget.
  struct RoundCounter {
    llvm::AllocaInst* rounds = nullptr;  ///< Of all lanes together: at least those of each.
    llvm::AllocaInst* lanes = nullptr;   ///< Of each lane; null when all lanes count alike.
  };

  /// Which exits part lanes, by the branch, loop or scope that they concern.
  struct Exits {
    bool passing = false;    ///< Some masked exit inside leads to an end further out.
    bool left = false;       ///< Some masked exit leads to its own end.
    bool continued = false;  ///< Some masked exit leads to its own step.
  };

  /// A comparison that has been emitted, or a combination of some: in the innermost loop around it, and how often what
  /// it compares had been written by then.
  struct Test {
    const lang::Instruction* instruction = nullptr;
    const lang::Instruction* loop = nullptr;
    std::vector<unsigned> writes;
    const lang::Code* code = nullptr;  ///< Of a flag: where the test was stored in it,
    unsigned ownWrites = 0;            ///< and how often it had been written then.
  };
  /// A component of a triple, in the innermost loop around it, and how often the triple had been written by then.
  struct Part {
    lang::VariableId whole = lang::noVariable;
    unsigned index = 0;
    const lang::Instruction* loop = nullptr;
    unsigned writes = 0;
  };

  // lowering.cpp: control flow
  void findExits(const lang::Code& code, std::vector<const lang::Instruction*>& enclosing);
  void emit(const lang::Code& code, bool maySkip = true);
  void emit(const lang::Instruction& instruction);
  void countSegment(const lang::Code& code, std::size_t begin);
  void emitBranch(const lang::Instruction& instruction);
  void emitSides(const lang::Instruction& instruction, llvm::Value* condition);
  void emitMaskedSides(const lang::Instruction& instruction, const Number& condition);
  llvm::Value* emitMaskedSide(const lang::Instruction& branch, bool holds, const Mask& mask);
  void emitScope(const lang::Instruction& instruction);
  void emitExit(const lang::Instruction& instruction);
  void emitTargetEnd(const Mask& before);
  bool isLeftOut(const lang::Instruction& branch, DearPart::Place place) const;
  Target& targetOf(const lang::Instruction& exit);
  Exits exitsOf(const lang::Instruction& control) const;
  Mask mask();
  void setMask(const Mask& mask);
  llvm::AllocaInst* maskSlot(const char* name);
  void addLanes(llvm::AllocaInst* slot, llvm::Value* lanes);
  llvm::Value* mustAfter(llvm::Value* mustBefore, llvm::Value* may, bool atStep = false);

  /// Emits code that does not always run, or behind which not all runs that has been emitted in it.
  class Sometimes {
   public:
    explicit Sometimes(Variables& variables) : variables_(variables) { variables_.beginSometimes(); }
    ~Sometimes() { variables_.endSometimes(); }
    Sometimes(const Sometimes&) = delete;
    Sometimes& operator=(const Sometimes&) = delete;

   private:
    Variables& variables_;
  };

  // lowering_conditions.cpp
  const lang::Instruction* innermostLoop() const;
  void rememberTest(const lang::Instruction& instruction);
  void rememberFlag(const lang::Instruction& instruction);
  void rememberPart(const lang::Instruction& instruction);
  const Part* partOf(lang::VariableId id) const;
  void learn(lang::VariableId condition, bool holds, llvm::function_ref<bool(lang::VariableId)> concerns,
             std::vector<lang::VariableId>& cut);
  void learnComparison(const lang::Instruction& test, bool holds, llvm::function_ref<bool(lang::VariableId)> concerns,
                       std::vector<lang::VariableId>& cut);
  void forget(const std::vector<lang::VariableId>& cut);
  void emitUnder(const lang::Instruction& branch, bool holds);
  void learnFromExit(const lang::Instruction& branch, std::span<const lang::Instruction> rest,
                     std::vector<lang::VariableId>& cut);
  Value readUnder(lang::VariableId condition, bool holds, lang::VariableId operand);

  // lowering_loops.cpp
  void emitLoop(const lang::Instruction& instruction);
  void emitLoopTest(const lang::Instruction& instruction, llvm::BasicBlock* body);
  void emitLoopBody(const lang::Instruction& instruction, llvm::BasicBlock* next, const RoundCounter& counter);
  bool isUnrolled(const lang::Instruction& instruction) const;
  void unroll(llvm::BasicBlock* latch);
  RoundCounter makeRoundCounter(const lang::Instruction& instruction);
  void emitRoundCount(const lang::Instruction& instruction, const RoundCounter& counter);
  void emitOutOfBudget(const lang::Instruction& instruction, const RoundCounter& counter, llvm::Value* budget,
                       llvm::BasicBlock* goOn);
  void reportBudget(const lang::Instruction& instruction, llvm::Value* lanes);
  void widenWritten(const lang::Code& code, const Mask& lanes);

  // lowering_operations.cpp
  void emitOperation(const lang::Instruction& instruction);
  Value operate(const lang::Instruction& instruction);
  Value operateBinary(const lang::Instruction& instruction);
  Value squares(const Value& a);
  Value operateUnary(const lang::Instruction& instruction);
  Value multiplyOrDivide(lang::Op op, const Value& a, const Value& b);
  Value multiplyMatrices(const Value& a, const Value& b);
  Value equality(lang::Op op, const Value& a, const Value& b);
  Value selectValue(const lang::Instruction& instruction);
  Number binary(lang::Op op, Number a, Number b);
  Number unary(lang::Op op, const Number& x);
  Number select(const Number& condition, Number a, Number b);
  Number asFloat(const Number& x) { return x.kind == Kind::floating ? x : unary(lang::Op::toFloat, x); }
  Number integer(std::int32_t value);
  Number floating(double value);
  Number number(lang::VariableId variable) { return variables_.read(variable)[0]; }
  void write(const lang::Instruction& instruction, lang::VariableId variable, const Value& value);

  // lowering_indices.cpp: parts of values
  void emitIndexed(const lang::Instruction& instruction);
  void emitSetPart(const lang::Instruction& instruction, const Number& index, const Number& part);
  void emitSetElement(const lang::Instruction& instruction);
  Value readElement(const lang::Instruction& instruction);
  Number pick(const Value& value, const Number& index);
  Number matrixIndex(const lang::Instruction& instruction, lang::VariableId row, lang::VariableId column);
  Number checkedIndex(const lang::Instruction& instruction, const Number& index, unsigned length,
                      const std::string& name);
  llvm::Value* elementAddress(const ArrayMemory& array, const Number& index);
  void copyArray(const lang::Instruction& instruction);
  void copyElements(const ArrayMemory& to, const ArrayMemory& from, const Mask* blend);

  // lowering_calls.cpp
  bool isSquaredLength(const lang::Instruction& instruction) const;
  bool isObjectPoint(const lang::Instruction& instruction) const;
  void emitCall(const lang::Instruction& instruction);
  Value callFunction(const std::string& symbol, llvm::ArrayRef<Value> arguments, llvm::ArrayRef<Kind> result);
  void emitFunctionCall(const std::string& symbol, bool varying, llvm::ArrayRef<llvm::Value*> pointers);
  llvm::Value* argumentMemory(const Value& value, bool varying);
  llvm::Value* argumentArray(const ArrayMemory& array, bool varying);
  Value loadValue(llvm::Value* memory, llvm::ArrayRef<Kind> kinds, bool varying);

  // lowering_host.cpp
  void emitHostCall(const lang::Instruction& instruction);
  std::uint32_t addHostSite(const lang::Instruction& instruction);
  llvm::Value* hostArgument(const lang::Instruction& instruction, std::size_t index, bool varies);
  void widenResults(const lang::Instruction& instruction);
  void callHostService(const lang::Instruction& instruction, llvm::Value* values, llvm::Value* high, bool varies);

  // lowering_native.cpp
  void emitNativeCall(const lang::Instruction& instruction, bool varies);
  void emitRangeCall(const lang::Instruction& instruction);
  bool hasRange(const lang::Instruction& instruction) const;
  llvm::Value* lanesOfCall(bool varies);
  llvm::Value* pointerTable(llvm::ArrayRef<llvm::Value*> pointers);
  llvm::Value* endsMemory(const Value& value, unsigned end);
  llvm::Value* unknownLanes(const Value& value);
  Value loadEnds(llvm::ArrayRef<Kind> kinds, llvm::Value* low, llvm::Value* high, llvm::Value* unknown);

  // lowering_spaces.cpp
  void emitMatrixOfSpaces(const lang::Instruction& instruction);
  /// A matrix, and whether its space is known; an empty matrix is the identity.
  struct SpaceMatrix {
    Value matrix;
    Number known;
  };
  SpaceMatrix spaceMatrix(lang::VariableId space, bool toWorld, const lang::Instruction& instruction);
  SpaceMatrix headerMatrix(unsigned first);
  SpaceMatrix hostMatrix(const Number& space, bool toWorld, const lang::Instruction& instruction);
  Value fromRows(llvm::ArrayRef<Number> rows);

  // lowering_messages.cpp
  void emitMessage(const lang::Instruction& instruction);
  void report(std::uint32_t kind, std::uint32_t location, const std::string& text, std::vector<lang::Type> types,
              const Value& values, llvm::Value* lanes);
  llvm::Value* recordValue(const Number& number);
  llvm::Function* recordFunction();
  void fillRecordFunction(llvm::Function& function);
  llvm::Value* hostService(Emitter& emitter, llvm::Value* context, std::size_t offset);

  Emitter& e_;
  NumberDomain& domain_;
  KernelFrame& frame_;
  Variables& variables_;
  const lang::Program& program_;
  const lang::Uniformity& uniformity_;
  KernelInterface& interface_;
  LoweringOptions options_;

  Cost cost_;

  llvm::AllocaInst* may_ = nullptr;      ///< The mask in memory, so that control flow can merge it.
  llvm::AllocaInst* must_ = nullptr;     ///< Null where `must` is `may`.
  llvm::AllocaInst* stopped_ = nullptr;  ///< Null where nothing is left out.
  std::vector<Target> targets_;
  std::unordered_map<const lang::Instruction*, Exits> exits_;
  std::unordered_map<lang::VariableId, Test> tests_;
  std::unordered_map<lang::VariableId, Part> parts_;
  std::vector<const lang::Code*> codes_;                 ///< Those that are being emitted, the innermost one last.
  std::unordered_set<lang::VariableId> objectMatrices_;  ///< Temporaries that hold the map from world to object space.
  llvm::Function* recordFunction_ = nullptr;
};

}  // namespace aerosol::jit

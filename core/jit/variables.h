// Where the values of a program's variables live while a kernel runs.
#pragma once

#include <map>
#include <vector>

#include "core/jit/kernel_frame.h"
#include "core/lang/program.h"
#include "core/lang/uniformity.h"

namespace aerosol::jit {

/// Temporaries are SSA values, unwritten parameters and globals are what was passed, constants are constants;
/// everything else has stack slots, one a number, which later passes lift into registers. Arrays are in memory.
class Variables {
 public:
  Variables(Emitter& emitter, NumberDomain& domain, KernelFrame& frame, const KernelInterface& interface,
            const lang::Program& program, const lang::Uniformity& uniformity);

  bool isArray(lang::VariableId id) const { return program_.variables[id].type.isArray(); }
  bool isVarying(lang::VariableId id) const { return uniformity_.isVarying(id); }

  /// Of what is no array: its numbers.
  Value read(lang::VariableId id);
  /// Sets it, for the lanes of the mask only where one is given.
  void write(lang::VariableId id, const Value& value, const Mask* blend);
  ArrayMemory array(lang::VariableId id);
  /// How often it has been written in the code so far.
  unsigned writesSoFar(lang::VariableId id) const { return writes_[id]; }

  /// Until `endNarrow`, reads give this value, which is known of what nothing writes in between. They nest.
  void narrow(lang::VariableId id, Value value) { narrowed_[id].push_back(std::move(value)); }
  void endNarrow(lang::VariableId id);

  /// From here to `endSometimes`, what is emitted does not always run before what is emitted later. They nest.
  void beginSometimes() { ++sometimes_; }
  void endSometimes() { --sometimes_; }

  /// Any value becomes possible in the lanes of the mask.
  void widen(lang::VariableId id, const Mask& mask);

  /// Kinds of the components of a variable (of one element of an array).
  llvm::ArrayRef<Kind> kinds(lang::VariableId id);
  Number zero(Kind kind);
  Value constant(const lang::Type& type, const lang::ConstantValue& value);
  /// Memory of `count` numbers in a row as an array has them.
  llvm::AllocaInst* memory(llvm::ArrayRef<Kind> element, unsigned length, bool varying, const char* name);
  /// Byte offset of a component of an element.
  std::uint64_t offsetOf(const ArrayMemory& array, unsigned element, unsigned component) const;

 private:
  bool isDirect(lang::VariableId id) const;
  Value initial(lang::VariableId id);
  const InstanceField* fieldOf(const lang::Variable& variable) const;
  std::vector<llvm::AllocaInst*>& slots(lang::VariableId id);
  ArrayMemory constantArray(const lang::Variable& variable, llvm::ArrayRef<Kind> element);
  void initialiseArray(lang::VariableId id, const ArrayMemory& array, Value start);
  template <class Function>
  void beforeUse(Function&& emit);

  Emitter& e_;
  NumberDomain& domain_;
  KernelFrame& frame_;
  const KernelInterface& interface_;
  const lang::Program& program_;
  const lang::Uniformity& uniformity_;

  std::vector<llvm::SmallVector<Kind, 4>> kinds_;
  unsigned sometimes_ = 0;
  std::vector<unsigned> writes_;
  std::map<lang::VariableId, Value> values_;
  std::map<lang::VariableId, std::vector<Value>> narrowed_;
  std::map<lang::VariableId, std::vector<llvm::AllocaInst*>> slots_;
  std::map<lang::VariableId, ArrayMemory> arrays_;
};

}  // namespace aerosol::jit

// What surrounds a program's code in a kernel: the loop over chunks of lanes, and everything that comes in or goes out.
#pragma once

#include <array>
#include <map>
#include <utility>

#include "core/jit/domain.h"
#include "core/jit/kernel_interface.h"

namespace aerosol::jit {

/// Kinds of the components of a value (of one element of an array). Closures have none of their own.
llvm::SmallVector<Kind, 4> kindsOf(const lang::Type& type);

/// Function `void kernel(const AerosolKernelArguments*)`, declared in the module.
llvm::Function* declareKernel(llvm::Module& module);

/// Emits the frame around the code of a program. Between `begin` and `end` the emitter stands in the loop's body. What
/// comes in is loaded where it is asked for first, but placed at the beginning: of the kernel, when it is uniform, or
/// of the chunk.
class KernelFrame {
 public:
  KernelFrame(Emitter& emitter, NumberDomain& domain, const KernelInterface& interface, bool severalInstances);

  void begin();
  void end();

  /// Lanes of the chunk whose points are active.
  Mask active() const { return active_; }
  llvm::Value* context() const { return context_; }
  /// Index in the batch of the chunk's first point.
  llvm::Value* base() const { return base_; }
  llvm::Value* loopBudget();

  /// A component of a global, by its number among the pointers of a wide kernel. Range kernels: also, after the
  /// globals, those of P in object space.
  Number global(unsigned component);
  /// A parameter in the instance block.
  Value field(const InstanceField& field);
  ArrayMemory arrayField(const InstanceField& field, llvm::ArrayRef<Kind> element);
  /// A float of the instance's header.
  Number header(unsigned index);
  /// Index of the instance of a lane, as i32.
  llvm::Value* instanceOf(llvm::Value* lane);

  /// Output pointer number `index` receives a part of a result in the active lanes.
  void storeOutput(unsigned index, llvm::Value* lanes);

  /// Adds to the counters when the kernel ends: `lanesRun` in lanes, `lanesUsed` by the mask.
  void count(unsigned cost, const Mask& mask);

  /// Runs `emit` at the end of the kernel's entry, or of the chunk's beginning.
  template <class Function>
  auto atEntry(Function&& emit) {
    llvm::IRBuilder<>::InsertPointGuard guard(e_.ir);
    e_.ir.SetInsertPoint(entryEnd_);
    return emit();
  }
  template <class Function>
  auto atChunkStart(Function&& emit) {
    llvm::IRBuilder<>::InsertPointGuard guard(e_.ir);
    e_.ir.SetInsertPoint(chunkStartEnd_);
    return emit();
  }

 private:
  llvm::Value* argument(unsigned offset, llvm::Type* type);
  llvm::Value* activeLanes(llvm::Value* count);
  llvm::Value* lanesAt(llvm::Value* pointer, llvm::Type* type, unsigned bytes);
  void prepareInstances();
  Number instanceNumber(Kind kind, unsigned offset);
  void flushCounters();

  Emitter& e_;
  NumberDomain& domain_;
  const KernelInterface& interface_;
  bool severalInstances_;

  llvm::Instruction* entryEnd_ = nullptr;
  llvm::Instruction* chunkStartEnd_ = nullptr;
  llvm::BasicBlock* chunk_ = nullptr;
  llvm::BasicBlock* latch_ = nullptr;
  llvm::BasicBlock* exit_ = nullptr;
  llvm::PHINode* base_ = nullptr;
  llvm::Value* arguments_ = nullptr;
  llvm::Value* context_ = nullptr;
  llvm::Value* count_ = nullptr;
  llvm::Value* loopBudget_ = nullptr;
  llvm::Value* globals_ = nullptr;
  llvm::Value* outputs_ = nullptr;
  llvm::Value* instanceData_ = nullptr;
  Mask active_;
  std::map<unsigned, Number> globalNumbers_;
  std::map<std::pair<unsigned, Kind>, Number> instanceNumbers_;
  std::map<unsigned, llvm::Value*> outputPointers_;

  // Several instances: all lanes of one instance read it once; otherwise each lane reads for itself.
  llvm::Value* instances_ = nullptr;      ///< Lanes; 0 where inactive.
  llvm::Value* firstInstance_ = nullptr;  ///< Pointer to the block of the chunk's first active lane.
  llvm::Instruction* sameEnd_ = nullptr;
  llvm::Instruction* mixedEnd_ = nullptr;
  llvm::BasicBlock* joined_ = nullptr;
  llvm::Value* blockOffsets_ = nullptr;  ///< Lanes of i64: where each lane's block starts.

  llvm::AllocaInst* lanesRun_ = nullptr;
  llvm::AllocaInst* lanesUsed_ = nullptr;
};

}  // namespace aerosol::jit

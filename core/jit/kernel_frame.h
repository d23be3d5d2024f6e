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

/// Begins the kernel's entry, where what stays the same for all points is loaded. Gives the entry's end; the emitter
/// stands in the block behind it.
llvm::Instruction* beginEntry(Emitter& emitter);

/// The points that a loop over chunks goes through: those from `first` to before `end`, or, with a list, those whose
/// indices the list holds at these places.
struct PointRange {
  llvm::Value* first = nullptr;
  llvm::Value* end = nullptr;
  llvm::Value* list = nullptr;  ///< Array of i32, aligned and padded to chunks.
};

/// Emits the frame around the code of a program: a loop over chunks of points. Between `begin` and `end` the emitter
/// stands in the loop's body. What comes in is loaded where it is asked for first, but placed at the beginning: of the
/// kernel, when it is uniform, or of the chunk.
class KernelFrame {
 public:
  KernelFrame(Emitter& emitter, NumberDomain& domain, const KernelInterface& interface, bool severalInstances,
              llvm::Instruction* entryEnd);

  void begin(const PointRange& points);
  /// Ends the loop; the emitter stands behind it.
  void end();

  /// Number of points in the batch.
  llvm::Value* count() const { return count_; }
  /// Lanes of the chunk whose points are active.
  Mask active() const { return active_; }
  llvm::Value* context() const { return context_; }
  /// The kernel's AerosolKernelArguments.
  llvm::Value* arguments() const { return arguments_; }
  /// Where the chunk begins: in the batch, or in the list.
  llvm::Value* base() const { return base_; }
  /// The list of points; a null pointer without one.
  llvm::Value* list() { return list_ ? list_ : e_.zero(e_.ir.getPtrTy()); }
  /// Appends the indices of the lanes' points to an array of i32, at a place that is counted up. Not at width 1.
  void append(llvm::Value* lanes, llvm::Value* array, llvm::AllocaInst* place);
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

  /// Output pointer number `index` receives a part of a result in some of the active lanes.
  void storeOutput(unsigned index, llvm::Value* lanes, llvm::Value* mask);

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
  llvm::Value* lanesBefore(llvm::Value* end);
  llvm::Value* lanesWithFlag(llvm::Value* inside, llvm::BasicBlock* start);
  llvm::Value* pointAddresses(llvm::Value* pointer, unsigned bytes);
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
  llvm::Value* last_ = nullptr;  ///< Where the range ends.
  llvm::Value* list_ = nullptr;
  llvm::Value* indices_ = nullptr;  ///< Lanes of i32: the points' indices in the batch.
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

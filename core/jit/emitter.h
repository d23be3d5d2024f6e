// The IR builder with what all parts of code generation need: lane types, masks, stack slots.
#pragma once

#include <cstdint>
#include <string>

#include "core/jit/llvm.h"
#include "core/jit/target.h"

namespace aerosol::jit {

/// The kinds of numbers that values are made of. Strings are their 64-bit hashes.
enum class Kind : std::uint8_t { floating, integer, string };

/// Emits into one function. At width 1 lane types are the scalar types.
class Emitter {
 public:
  /// `library` is the run-time library that the code will be linked with.
  Emitter(llvm::Function& function, Target target, const llvm::Module& library);

  llvm::IRBuilder<> ir;

  llvm::LLVMContext& context() { return function_.getContext(); }
  llvm::Module& module() { return *function_.getParent(); }
  llvm::Function& function() { return function_; }
  unsigned width() const { return width_; }
  Target target() const { return target_; }
  const llvm::Module& library() const { return library_; }

  llvm::Type* scalarType(Kind kind);
  llvm::Type* laneType(llvm::Type* scalar);
  llvm::Type* laneType(Kind kind) { return laneType(scalarType(kind)); }
  llvm::Type* maskType() { return laneType(ir.getInt1Ty()); }
  /// Bytes of one number of lanes, which is also its alignment.
  unsigned laneBytes(Kind kind) const { return width_ * (kind == Kind::string ? 8 : 4); }

  /// The same scalar in all lanes.
  llvm::Value* splat(llvm::Value* scalar);
  llvm::Constant* splat(llvm::Constant* scalar);
  /// 0, 1, 2 …
  llvm::Constant* laneNumbers();
  llvm::Constant* zero(llvm::Type* type) { return llvm::Constant::getNullValue(type); }

  llvm::Constant* noLanes() { return zero(maskType()); }
  llvm::Constant* allLanes() { return llvm::Constant::getAllOnesValue(maskType()); }
  /// Is the mask set in any lane? As i1.
  llvm::Value* any(llvm::Value* mask);
  /// Bit i is lane i, as i32.
  llvm::Value* bits(llvm::Value* mask);
  llvm::Value* both(llvm::Value* a, llvm::Value* b) { return ir.CreateAnd(a, b); }
  llvm::Value* without(llvm::Value* a, llvm::Value* b) { return ir.CreateAnd(a, ir.CreateNot(b)); }

  /// A stack slot, made once at the function's entry.
  llvm::AllocaInst* slot(llvm::Type* type, const char* name, unsigned alignment = 0);
  llvm::BasicBlock* block(const char* name);
  /// Branches to the block and goes on there.
  void enter(llvm::BasicBlock* block);
  /// A load or store at a byte offset, aligned to what the type's size allows up to `alignment`.
  llvm::Value* loadAt(llvm::Type* type, llvm::Value* base, llvm::Value* byteOffset, unsigned alignment);
  llvm::Value* pointerAt(llvm::Value* base, std::uint64_t byteOffset);
  /// Does the run-time library have this function?
  bool libraryHas(const std::string& symbol) const { return library_.getFunction(symbol) != nullptr; }
  /// Calls a function of the run-time library, which knows nothing but its arguments, and comes back.
  void callLibrary(const std::string& symbol, llvm::ArrayRef<llvm::Value*> pointers);

 private:
  llvm::Function& function_;
  Target target_;
  const llvm::Module& library_;
  unsigned width_;
};

}  // namespace aerosol::jit

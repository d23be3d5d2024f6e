#include "core/jit/emitter.h"

namespace aerosol::jit {

Emitter::Emitter(llvm::Function& function, Target target, const llvm::Module& library)
    : ir(function.getContext()),
      function_(function),
      target_(target),
      library_(library),
      width_(static_cast<unsigned>(target.width)) {}

llvm::Type* Emitter::scalarType(Kind kind) {
  switch (kind) {
    case Kind::floating:
      return ir.getFloatTy();
    case Kind::integer:
      return ir.getInt32Ty();
    case Kind::string:
      return ir.getInt64Ty();
  }
  return nullptr;
}

llvm::Type* Emitter::laneType(llvm::Type* scalar) {
  return width_ == 1 ? scalar : llvm::FixedVectorType::get(scalar, width_);
}

llvm::Value* Emitter::splat(llvm::Value* scalar) { return width_ == 1 ? scalar : ir.CreateVectorSplat(width_, scalar); }

llvm::Constant* Emitter::splat(llvm::Constant* scalar) {
  return width_ == 1 ? scalar : llvm::ConstantVector::getSplat(llvm::ElementCount::getFixed(width_), scalar);
}

llvm::Constant* Emitter::laneNumbers() {
  llvm::SmallVector<llvm::Constant*, 16> numbers;
  for (unsigned i = 0; i < width_; ++i) numbers.push_back(ir.getInt32(i));
  return width_ == 1 ? numbers[0] : llvm::ConstantVector::get(numbers);
}

llvm::Value* Emitter::any(llvm::Value* mask) {
  if (width_ == 1) return mask;
  return ir.CreateICmpNE(ir.CreateBitCast(mask, ir.getIntNTy(width_)), ir.getIntN(width_, 0));
}

llvm::Value* Emitter::bits(llvm::Value* mask) {
  return ir.CreateZExt(ir.CreateBitCast(mask, ir.getIntNTy(width_)), ir.getInt32Ty());
}

llvm::AllocaInst* Emitter::slot(llvm::Type* type, const char* name, unsigned alignment) {
  llvm::BasicBlock& entry = function_.getEntryBlock();
  llvm::IRBuilder<> builder(&entry, entry.getFirstInsertionPt());
  llvm::AllocaInst* result = builder.CreateAlloca(type, nullptr, name);
  if (alignment > 0) result->setAlignment(llvm::Align(alignment));
  return result;
}

llvm::BasicBlock* Emitter::block(const char* name) { return llvm::BasicBlock::Create(context(), name, &function_); }

void Emitter::enter(llvm::BasicBlock* block) {
  if (!ir.GetInsertBlock()->getTerminator()) ir.CreateBr(block);
  ir.SetInsertPoint(block);
}

llvm::Value* Emitter::loadAt(llvm::Type* type, llvm::Value* base, llvm::Value* byteOffset, unsigned alignment) {
  return ir.CreateAlignedLoad(type, ir.CreateInBoundsGEP(ir.getInt8Ty(), base, byteOffset), llvm::Align(alignment));
}

llvm::Value* Emitter::pointerAt(llvm::Value* base, std::uint64_t byteOffset) {
  return byteOffset == 0 ? base : ir.CreateInBoundsGEP(ir.getInt8Ty(), base, ir.getInt64(byteOffset));
}

void Emitter::callLibrary(const std::string& symbol, llvm::ArrayRef<llvm::Value*> pointers) {
  const llvm::SmallVector<llvm::Type*, 8> types(pointers.size(), ir.getPtrTy());
  auto* const type = llvm::FunctionType::get(ir.getVoidTy(), types, false);
  llvm::CallInst* const call = ir.CreateCall(module().getOrInsertFunction(symbol, type), pointers);
  call->setDoesNotThrow();
  call->setOnlyAccessesArgMemory();
  call->addFnAttr(llvm::Attribute::WillReturn);
  call->addFnAttr(llvm::Attribute::NoFree);
  call->addFnAttr(llvm::Attribute::NoSync);
  for (unsigned i = 0; i < pointers.size(); ++i) call->addParamAttr(i, llvm::Attribute::NoCapture);
}

}  // namespace aerosol::jit

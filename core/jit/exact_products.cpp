#include "core/jit/exact_products.h"

#include <cmath>

#include "core/jit/llvm.h"

namespace aerosol::jit {

namespace {

/// A power of two near enough to 1 that ints times it are neither too small nor too large.
bool isScale(const llvm::Value* value) {
  const auto* constant = llvm::dyn_cast<llvm::Constant>(value);
  if (!constant) return false;
  const llvm::Constant* one = constant->getType()->isVectorTy() ? constant->getSplatValue() : constant;
  const auto* number = llvm::dyn_cast_or_null<llvm::ConstantFP>(one);
  if (!number || !number->getType()->isFloatTy()) return false;
  int exponent = 0;
  const float fraction = std::frexp(number->getValueAPF().convertToFloat(), &exponent);
  return std::fabs(fraction) == 0.5f && exponent > -64 && exponent < 64;
}

bool isInt(const llvm::Value* value) {
  const auto* conversion = llvm::dyn_cast<llvm::CastInst>(value);
  if (!conversion) return false;
  const auto opcode = conversion->getOpcode();
  return (opcode == llvm::Instruction::UIToFP || opcode == llvm::Instruction::SIToFP) &&
         conversion->getSrcTy()->getScalarSizeInBits() <= 32;
}

/// The exact product that nothing but the sum needs.
llvm::BinaryOperator* exactProduct(llvm::Value* value) {
  auto* const product = llvm::dyn_cast<llvm::BinaryOperator>(value);
  if (!product || product->getOpcode() != llvm::Instruction::FMul || !product->hasOneUse()) return nullptr;
  llvm::Value* const a = product->getOperand(0);
  llvm::Value* const b = product->getOperand(1);
  return (isInt(a) && isScale(b)) || (isInt(b) && isScale(a)) ? product : nullptr;
}

}  // namespace

void fuseExactProducts(llvm::Function& function) {
  for (llvm::BasicBlock& block : function) {
    for (llvm::Instruction& instruction : llvm::make_early_inc_range(block)) {
      if (instruction.getOpcode() != llvm::Instruction::FAdd) continue;
      for (unsigned i = 0; i < 2; ++i) {
        llvm::BinaryOperator* const product = exactProduct(instruction.getOperand(i));
        if (!product) continue;
        llvm::IRBuilder<> builder(&instruction);
        instruction.replaceAllUsesWith(
            builder.CreateIntrinsic(llvm::Intrinsic::fma, {instruction.getType()},
                                    {product->getOperand(0), product->getOperand(1), instruction.getOperand(1 - i)}));
        instruction.eraseFromParent();
        product->eraseFromParent();
        break;
      }
    }
  }
}

}  // namespace aerosol::jit

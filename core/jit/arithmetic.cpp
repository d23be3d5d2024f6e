#include "core/jit/arithmetic.h"

#include <limits>

namespace aerosol::jit {

using lang::Op;
using llvm::Value;

Value* Arithmetic::isTrue(Value* x) { return e_.ir.CreateICmpNE(x, e_.zero(x->getType())); }

Value* Arithmetic::toInt(Value* condition) {
  return e_.ir.CreateZExt(condition, condition->getType()->getWithNewType(e_.ir.getInt32Ty()));
}

Value* Arithmetic::compare(Op op, Kind kind, Value* a, Value* b) {
  using Predicate = llvm::CmpInst::Predicate;
  const bool isFloat = kind == Kind::floating;
  switch (op) {
    case Op::less:
      return e_.ir.CreateCmp(isFloat ? Predicate::FCMP_OLT : Predicate::ICMP_SLT, a, b);
    case Op::lessEqual:
      return e_.ir.CreateCmp(isFloat ? Predicate::FCMP_OLE : Predicate::ICMP_SLE, a, b);
    case Op::greater:
      return e_.ir.CreateCmp(isFloat ? Predicate::FCMP_OGT : Predicate::ICMP_SGT, a, b);
    case Op::greaterEqual:
      return e_.ir.CreateCmp(isFloat ? Predicate::FCMP_OGE : Predicate::ICMP_SGE, a, b);
    case Op::equal:
      return e_.ir.CreateCmp(isFloat ? Predicate::FCMP_OEQ : Predicate::ICMP_EQ, a, b);
    default:
      return e_.ir.CreateCmp(isFloat ? Predicate::FCMP_UNE : Predicate::ICMP_NE, a, b);
  }
}

Value* Arithmetic::divideFloats(Value* a, Value* b) {
  Value* const zero = e_.zero(b->getType());
  return e_.ir.CreateSelect(e_.ir.CreateFCmpOEQ(b, zero), zero, e_.ir.CreateFDiv(a, b));
}

/// Lanes of ints have no division instruction. Doubles hold every int and the nearest double to a quotient of two ints
/// truncates to the same int, because a quotient that is not whole is further from the next int than half a double's
/// spacing.
Value* Arithmetic::quotient(Value* a, Value* b) {
  const bool isLanes = a->getType()->isVectorTy();
  if (!isLanes || llvm::isa<llvm::Constant>(b)) return e_.ir.CreateSDiv(a, b);
  llvm::Type* const doubles = a->getType()->getWithNewType(e_.ir.getDoubleTy());
  Value* const q = e_.ir.CreateFDiv(e_.ir.CreateSIToFP(a, doubles), e_.ir.CreateSIToFP(b, doubles));
  return e_.ir.CreateFPToSI(q, a->getType());
}

Value* Arithmetic::divideInts(Value* a, Value* b, bool remainder) {
  llvm::Type* const type = a->getType();
  Value* const isZero = e_.ir.CreateICmpEQ(b, e_.zero(type));
  Value* const lowest = llvm::ConstantInt::getSigned(type, std::numeric_limits<std::int32_t>::min());
  Value* const overflows =
      e_.ir.CreateAnd(e_.ir.CreateICmpEQ(a, lowest), e_.ir.CreateICmpEQ(b, llvm::ConstantInt::getSigned(type, -1)));
  // By 1 the lowest int gives itself, and no remainder, which is what wrapping asks for; so is x % 0 = 0.
  Value* const divisor = e_.ir.CreateSelect(e_.ir.CreateOr(isZero, overflows), llvm::ConstantInt::get(type, 1), b);
  Value* const q = quotient(a, divisor);
  if (remainder) return e_.ir.CreateSub(a, e_.ir.CreateMul(q, divisor));
  return e_.ir.CreateSelect(isZero, e_.zero(type), q);
}

Value* Arithmetic::binary(Op op, Kind kind, Value* a, Value* b) {
  const bool isFloat = kind == Kind::floating;
  switch (op) {
    case Op::add:
      return isFloat ? e_.ir.CreateFAdd(a, b) : e_.ir.CreateAdd(a, b);
    case Op::subtract:
      return isFloat ? e_.ir.CreateFSub(a, b) : e_.ir.CreateSub(a, b);
    case Op::multiply:
      return isFloat ? e_.ir.CreateFMul(a, b) : e_.ir.CreateMul(a, b);
    case Op::divide:
      return isFloat ? divideFloats(a, b) : divideInts(a, b, false);
    case Op::modulo:
      return divideInts(a, b, true);
    case Op::bitAnd:
      return e_.ir.CreateAnd(a, b);
    case Op::bitOr:
      return e_.ir.CreateOr(a, b);
    case Op::bitXor:
      return e_.ir.CreateXor(a, b);
    case Op::shiftLeft:
      return e_.ir.CreateShl(a, e_.ir.CreateAnd(b, llvm::ConstantInt::get(b->getType(), 31)));
    case Op::shiftRight:
      return e_.ir.CreateAShr(a, e_.ir.CreateAnd(b, llvm::ConstantInt::get(b->getType(), 31)));
    case Op::logicalAnd:
      return toInt(e_.ir.CreateAnd(isTrue(a), isTrue(b)));
    case Op::logicalOr:
      return toInt(e_.ir.CreateOr(isTrue(a), isTrue(b)));
    default:
      return toInt(compare(op, kind, a, b));
  }
}

/// Truncates; saturates, and NaN gives 0. (Of lanes LLVM 19's saturating conversion becomes a dozen instructions each.)
Value* Arithmetic::truncated(Value* x) {
  llvm::Type* const ints = x->getType()->getWithNewType(e_.ir.getInt32Ty());
  if (!x->getType()->isVectorTy()) {
    return e_.ir.CreateIntrinsic(llvm::Intrinsic::fptosi_sat, {ints, x->getType()}, {x});
  }
  Value* const lowest = llvm::ConstantFP::get(x->getType(), -2147483648.0);
  Value* const beyond = llvm::ConstantFP::get(x->getType(), 2147483648.0);
  Value* const atLeast = e_.ir.CreateSelect(e_.ir.CreateFCmpOLT(lowest, x), x, lowest);
  Value* const largest = llvm::ConstantInt::get(ints, 0x7fffffff);
  Value* const inside = e_.ir.CreateSelect(e_.ir.CreateFCmpOGE(x, beyond), largest, e_.ir.CreateFPToSI(atLeast, ints));
  return e_.ir.CreateSelect(e_.ir.CreateFCmpUNO(x, x), e_.zero(ints), inside);
}

Value* Arithmetic::unary(Op op, Kind kind, Value* x) {
  switch (op) {
    case Op::negate:
      return kind == Kind::floating ? e_.ir.CreateFNeg(x) : e_.ir.CreateNeg(x);
    case Op::bitNot:
      return e_.ir.CreateNot(x);
    case Op::logicalNot:
      return toInt(e_.ir.CreateICmpEQ(x, e_.zero(x->getType())));
    case Op::toFloat:
      return kind == Kind::floating ? x : e_.ir.CreateSIToFP(x, x->getType()->getWithNewType(e_.ir.getFloatTy()));
    case Op::toInt:
      if (kind != Kind::floating) return x;
      return truncated(x);
    default:  // toBool
      return toInt(compare(Op::notEqual, kind, x, e_.zero(x->getType())));
  }
}

}  // namespace aerosol::jit

// The language's operators on numbers in IR, on scalars and on lanes alike.
#pragma once

#include "core/jit/emitter.h"
#include "core/lang/program.h"

namespace aerosol::jit {

/// Total on all inputs, so that masked-off lanes compute safely: x/0 = 0, x%0 = 0, ints wrap, INT_MIN / -1 = INT_MIN,
/// shift counts are taken modulo 32, float to int saturates and takes NaN to 0. Booleans are ints 0 and 1. Floats
/// follow IEEE, in the order written.
class Arithmetic {
 public:
  explicit Arithmetic(Emitter& emitter) : e_(emitter) {}

  /// add … shiftRight, comparisons, logicalAnd, logicalOr. Both operands are of one kind and type. (Floats have no
  /// modulo here: that is a library function.)
  llvm::Value* binary(lang::Op op, Kind kind, llvm::Value* a, llvm::Value* b);
  /// negate, bitNot, logicalNot, toFloat, toInt, toBool.
  llvm::Value* unary(lang::Op op, Kind kind, llvm::Value* x);
  /// Is the int not 0? As i1 or lanes of it.
  llvm::Value* isTrue(llvm::Value* x);
  llvm::Value* toInt(llvm::Value* condition);

 private:
  llvm::Value* compare(lang::Op op, Kind kind, llvm::Value* a, llvm::Value* b);
  llvm::Value* divideFloats(llvm::Value* a, llvm::Value* b);
  llvm::Value* divideInts(llvm::Value* a, llvm::Value* b, bool remainder);
  llvm::Value* quotient(llvm::Value* a, llvm::Value* b);
  llvm::Value* truncated(llvm::Value* x);

  Emitter& e_;
};

}  // namespace aerosol::jit

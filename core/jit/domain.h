// The number domains that programs are lowered over, and the one interface through which all differences go.
#pragma once

#include <array>
#include <memory>

#include "core/jit/arithmetic.h"
#include "core/jit/emitter.h"
#include "core/lang/program.h"

namespace aerosol::jit {

/// A number of a domain. A uniform one is a plain scalar, exact in every domain, in `parts[0]`. A varying one has the
/// domain's parts, each with one lane a point.
struct Number {
  Kind kind = Kind::floating;
  bool varying = false;
  std::array<llvm::Value*, 8> parts{};
};

/// The numbers of a value, component after component.
using Value = llvm::SmallVector<Number, 4>;

/// Lanes that may run an instruction, and those among them that surely do. In the wide domain both are one. In the
/// range domain a lane is a box of points: `may` is set when some point may run it, `must` when all do, so masks of the
/// two sides of a branch overlap.
struct Mask {
  llvm::Value* may = nullptr;
  llvm::Value* must = nullptr;
};

/// Lanes in which a condition may hold, and in which it surely does.
struct Condition {
  llvm::Value* may = nullptr;
  llvm::Value* must = nullptr;
};

/// An array of numbers in memory: element after element, their components one after the other, each with its parts.
struct ArrayMemory {
  llvm::Value* base = nullptr;
  llvm::ArrayRef<Kind> element;  ///< Kinds of one element's components.
  unsigned length = 0;
  bool varying = false;
};

/// Emits what a number domain does its own way. Numbers given to `unary`, `binary`, `blend` … are varying.
class NumberDomain {
 public:
  explicit NumberDomain(Emitter& emitter) : e_(emitter), scalars_(emitter) {}
  virtual ~NumberDomain() = default;
  NumberDomain(const NumberDomain&) = delete;
  NumberDomain& operator=(const NumberDomain&) = delete;

  /// Of library functions: 'w', 'r'.
  virtual char symbolPrefix() const = 0;
  /// How many parts a varying number has, and their types.
  virtual unsigned partCount(Kind kind) const = 0;
  virtual llvm::Type* partType(Kind kind, unsigned part) = 0;
  /// Are `may` and `must` different values?
  virtual bool splitsMasks() const = 0;
  /// Does a loop that runs out of its budget leave the exact result (and a report), or is every variable that it writes
  /// widened to all values?
  virtual bool widensAtBudget() const = 0;

  /// The number that is known exactly in each lane.
  virtual Number exact(Kind kind, llvm::Value* lanes) = 0;
  /// The number that lies between two ends (the same one in exact domains), each with lanes.
  virtual Number between(llvm::Value* low, llvm::Value* high) = 0;
  Number broadcast(const Number& uniform) { return exact(uniform.kind, e_.splat(uniform.parts[0])); }
  /// Every value of the kind.
  virtual Number anything(Kind kind) = 0;
  virtual Number unary(lang::Op op, const Number& x) = 0;
  virtual Number binary(lang::Op op, const Number& a, const Number& b) = 0;
  /// x x, of which a range knows more than of a product.
  virtual Number square(const Number& x) { return binary(lang::Op::multiply, x, x); }
  virtual Number select(const Number& condition, const Number& a, const Number& b) = 0;
  virtual Condition condition(const Number& number) = 0;
  /// The value where the mask surely holds, the old one where it does not, and either where it may.
  virtual Number blend(const Mask& mask, const Number& value, const Number& old) = 0;

  /// The number, of which `known()` is known as well: both hold. Exact domains need no such knowledge.
  virtual Number narrowed(const Number& number, llvm::function_ref<Number()> known) {
    static_cast<void>(known);
    return number;
  }

  /// The number where it is known to be at most `limit` (or at least). `ordered`: neither is NaN then; otherwise NaN is
  /// possible as before, and where the limit may be NaN nothing is known. Exact domains need no such knowledge.
  virtual Number limited(const Number& number, const Number& limit, bool above, bool ordered) {
    static_cast<void>(limit), static_cast<void>(above), static_cast<void>(ordered);
    return number;
  }

  /// Lanes of an int outside [0, length).
  virtual llvm::Value* outside(const Number& index, unsigned length) = 0;
  virtual Number clampIndex(const Number& index, unsigned length) = 0;
  /// Component of the element at a varying index within [0, length). The array may be uniform.
  virtual Number readElement(const ArrayMemory& array, const Number& index, unsigned component) = 0;
  /// Writes to elements at a varying index under a mask. The array is varying.
  virtual void writeElement(const ArrayMemory& array, const Number& index, unsigned component, const Number& value,
                            const Mask& mask) = 0;

  Mask narrow(const Mask& mask, const Condition& condition);
  Mask narrowNot(const Mask& mask, const Condition& condition);
  Arithmetic& scalars() { return scalars_; }

  /// The number with lanes, whatever it was.
  Number varying(const Number& number) { return number.varying ? number : broadcast(number); }
  unsigned partBytes(Kind kind, bool varying) const;
  /// Bytes of one element of an array.
  unsigned elementBytes(llvm::ArrayRef<Kind> element, bool varying) const;
  unsigned componentOffset(llvm::ArrayRef<Kind> element, unsigned component, bool varying) const;
  Number load(Kind kind, bool varying, llvm::Value* address);
  void store(const Number& number, llvm::Value* address);

 protected:
  Emitter& e_;

 private:
  Arithmetic scalars_;
};

std::unique_ptr<NumberDomain> makeWideDomain(Emitter& emitter);
std::unique_ptr<NumberDomain> makeRangeDomain(Emitter& emitter);

}  // namespace aerosol::jit

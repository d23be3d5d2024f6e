// Writes the instructions of rules of differentiation.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

/// Appends pure instructions to a code. A variable `zero` (none) stands for a derivative that is zero: sums, products …
/// leave it out. What was computed since `begin` is not computed again, so rules need not care what they share.
class DerivativeBuilder {
 public:
  static constexpr VariableId zero = noVariable;

  explicit DerivativeBuilder(Program& program);

  /// Where instructions go from here on, and for which place of the source.
  void begin(Code& out, std::uint32_t location);

  VariableId number(float value);
  VariableId integer(std::int32_t value);
  VariableId add(VariableId a, VariableId b);
  VariableId subtract(VariableId a, VariableId b);
  VariableId multiply(VariableId a, VariableId b);
  VariableId divide(VariableId a, VariableId b);
  VariableId negate(VariableId a);
  VariableId square(VariableId a) { return multiply(a, a); }
  /// An int: `op` is less, lessEqual, equal … or logicalAnd.
  VariableId compare(Op op, VariableId a, VariableId b);
  VariableId select(VariableId condition, VariableId yes, VariableId no);
  VariableId component(VariableId triple, int index);
  VariableId triple(VariableId x, VariableId y, VariableId z);
  VariableId matrixElement(VariableId matrix, int row, int column);
  /// A library function by the base of its symbol, with a float, triple or matrix result.
  VariableId call(std::string_view base, const Type& result, std::vector<VariableId> arguments);
  VariableId call(std::string_view base, VariableId x);
  VariableId emit(Op op, const Type& type, std::vector<VariableId> arguments);
  /// The value as one of another type: a float for all components, a typed constant for `zero`.
  VariableId as(const Type& type, VariableId value);

  /// Whether the variable is a constant float of this value.
  bool isNumber(VariableId id, float value) const;
  bool isConstant(VariableId id) const;
  /// Whether a matrix surely leaves the fourth coordinate of points at 1: between named spaces.
  bool isAffine(VariableId matrix) const;
  const Type& typeOf(VariableId id) const { return program_.variables[id].type; }

  VariableId addVariable(Variable variable);
  VariableId temporary(const Type& type);
  Instruction& append(Op op);
  /// Index of a function that is called by that symbol.
  std::uint32_t function(const std::string& symbol, std::uint32_t outputs);
  /// The same of a function of the host.
  std::uint32_t hostFunction(const std::string& symbol, std::uint32_t outputs, std::uint8_t traits);

 private:
  VariableId constant(const Type& type, const ConstantValue& value);
  Type common(VariableId a, VariableId b) const;

  Program& program_;
  Code* out_ = nullptr;
  std::uint32_t location_ = 0;
  std::vector<bool> affine_;  ///< By variable of the program as it was given.
  std::map<std::string, VariableId> constants_;
  std::map<std::string, std::uint32_t> functions_;
  std::map<std::pair<std::string, std::vector<VariableId>>, VariableId> known_;  ///< Since `begin`.
};

}  // namespace aerosol::lang

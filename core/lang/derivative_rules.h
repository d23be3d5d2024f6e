// The rules of differentiation of library functions.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/lang/derivative_builder.h"

namespace aerosol::lang {

/// A call that has run, and one of its axes: its arguments (as they were before the call), their derivatives, the
/// result. Derivatives are `zero` where there is none.
struct DifferentiatedCall {
  std::string_view symbol;
  std::span<const VariableId> x;
  std::span<const VariableId> dx;
  VariableId y = noVariable;
};

/// Derivative of the result along the axis.
using DerivativeRule = VariableId (*)(DerivativeBuilder& b, const DifferentiatedCall& call);

struct FunctionRule {
  std::string_view base;  ///< Of the symbols that it is for.
  /// Null: the derivative is zero, or is not that of the result (`outputRule`).
  DerivativeRule rule = nullptr;
  /// Derivative of what the call writes to its last arguments; `output` is the argument's number.
  VariableId (*outputRule)(DerivativeBuilder& b, const DifferentiatedCall& call, std::size_t output) = nullptr;
  /// A noise: the base of the function that gives value and partial derivatives at once. Such functions take the
  /// coordinates (and periods), then a variable for each coordinate's partial derivative, a float or a triple as the
  /// result is; for a triple coordinate: one triple when the result is a float, otherwise three triples.
  std::string_view gradient = {};
  bool periodic = false;  ///< A noise: as many periods follow the coordinates.
};

/// Null when there is none for the symbol. Host functions are found by their name.
const FunctionRule* findFunctionRule(std::string_view symbol);
const FunctionRule* findFunctionRule(const FunctionUse& function);

/// The parts of `perlin_f_vf`: perlin, f, vf.
struct SymbolParts {
  std::string_view base;
  char result = 'x';
  std::string_view arguments;
};
SymbolParts takeApart(std::string_view symbol);

}  // namespace aerosol::lang

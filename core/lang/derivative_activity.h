// Which variables have derivatives, and which of those are wanted.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/lang/derivative_rules.h"
#include "core/lang/program.h"

namespace aerosol::lang {

inline constexpr std::size_t axisCount = 3;  ///< x, y and z.

/// A call that asks for derivatives of its argument.
enum class DerivativeQuery : std::uint8_t { dx, dy, dz, filterwidth, area, calculatenormal };
std::optional<DerivativeQuery> queryOf(const FunctionUse& function);
std::optional<DerivativeQuery> queryOf(const Program& program, const Instruction& instruction);

/// The global that holds a global's derivative along an axis; nothing where it has none.
std::optional<Global> derivativeGlobal(Global global, std::size_t axis);

/// Whether a type has derivatives: floats, triples, matrices, and arrays of these.
bool isContinuous(const Type& type);

/// Found without regard to order, as a fixpoint over the whole program: a variable varies when something written to it
/// has a derivative that may not be zero, and is wanted when a query reads it or a wanted variable is computed from it.
/// Only what varies *and* is wanted gets a derivative. (Griewank and Walther, Evaluating Derivatives, 2008, section
/// 6.2: activity analysis.)
class DerivativeActivity {
 public:
  explicit DerivativeActivity(const Program& program);

  bool isActive(VariableId id, std::size_t axis) const { return varied_[axis][id] && wanted_[axis][id]; }
  bool isActive(VariableId id) const { return isActive(id, 0) || isActive(id, 1) || isActive(id, 2); }

 private:
  void seed();
  void spread(std::size_t axis);
  void gather(std::size_t axis);

  struct Flow {
    VariableId from, to;
  };
  const Program& program_;
  std::vector<Flow> flows_;  ///< The derivative of `to` depends on that of `from`.
  std::array<std::vector<bool>, axisCount> varied_, wanted_;
};

}  // namespace aerosol::lang

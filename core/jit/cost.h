// What code costs, estimated from its text alone, so that policies built on it are the same on every machine.
#pragma once

#include <span>

#include "core/lang/program.h"

namespace aerosol::jit {

/// Instructions that one point runs: about one an operation on a number, library functions by their size. Both sides of
/// branches count, and a loop counts its rounds: exactly where it counts up between constants, else 8.
class Cost {
 public:
  explicit Cost(const lang::Program& program) : program_(program) {}

  double of(std::span<const lang::Instruction> code) const;
  /// Of the instructions themselves, not those in their bodies.
  double withoutBodies(std::span<const lang::Instruction> code) const;

 private:
  double ofOperation(const lang::Instruction& instruction) const;
  double ofCall(const lang::Instruction& instruction) const;
  double rounds(std::span<const lang::Instruction> code, std::size_t loop) const;
  bool constantInt(lang::VariableId id, double& value) const;
  double components(lang::VariableId id) const;

  const lang::Program& program_;
};

}  // namespace aerosol::jit

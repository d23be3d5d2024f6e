// Which closures a closure value may be made of, at every place of a program.
#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "core/lang/expand_layers.h"

namespace aerosol::lang {

/// Follows closure values through the structured code: an assignment replaces what a variable held, branches join,
/// loops run to a fixpoint. So `c = layer(coat, c)` has one coat more than before, and not as many as it pleases.
class ClosureFlow {
 public:
  ClosureFlow(Program& program, Layerings& layerings) : program_(program), layerings_(layerings) {}

  void run();

  /// The sites that a variable may hold anywhere.
  const Sites& anywhere(VariableId variable) const { return anywhere_[variable]; }
  /// Those of an instruction's argument.
  const Sites& at(const Instruction& instruction, std::size_t argument) const;
  /// Those at the end of the program.
  Sites atEnd(VariableId variable) const;
  /// What may lie on top in a layering, by its number.
  const std::map<std::uint32_t, Sites>& tops() const { return tops_; }

 private:
  using State = std::map<VariableId, Sites>;

  bool isClosure(VariableId variable) const {
    return variable != noVariable && program_.variables[variable].type.closure;
  }
  void follow(const Code& code);
  void followControl(const Instruction& instruction);
  void followLoop(const Instruction& loop);
  void record(const Instruction& instruction);
  Sites resultOf(const Instruction& instruction);
  static void join(State& state, const State& other);

  Program& program_;
  Layerings& layerings_;
  State state_;
  std::vector<Sites> anywhere_;
  std::unordered_map<const Instruction*, std::vector<Sites>> arguments_;
  std::map<std::uint32_t, Sites> tops_;
  std::vector<State> loopExits_;
  std::map<std::uint32_t, State> scopeExits_;
};

}  // namespace aerosol::lang

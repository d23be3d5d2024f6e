// All light path expressions of a render as one deterministic automaton.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/render/aov/light_path_expression.h"

namespace aerosol::render {

/// Reads one symbol at each event of a path; at its end the state tells which expressions match. Const.
class LightPathAutomaton {
 public:
  using State = std::uint32_t;
  static constexpr State dead = 0;  ///< Nothing can match any more.

  /// Nothing matches.
  LightPathAutomaton() = default;
  /// `symbolCount` symbols in all. None of the expressions is changed by the others. At most `mostStates` states, else
  /// `isTooLarge`.
  LightPathAutomaton(std::span<const LightPathExpression> expressions, std::size_t symbolCount);

  static constexpr std::size_t mostStates = 4096;
  bool isTooLarge() const { return isTooLarge_; }

  State start() const { return start_; }
  State next(State state, PathSymbol symbol) const { return arrows_[state * classCount_ + classes_[symbol]]; }
  /// The indices of the expressions that match a path which ends in this state.
  std::span<const std::uint32_t> matches(State state) const { return matches_[state]; }

  std::size_t stateCount() const { return matches_.size(); }

 private:
  /// Joins states that nothing can tell apart.
  void minimize();

  State start_ = dead;
  std::size_t classCount_ = 1;                              ///< Of symbols that all expressions treat alike.
  std::vector<std::uint32_t> classes_;                      ///< By symbol.
  std::vector<State> arrows_ = {dead};                      ///< By state, then class.
  std::vector<std::vector<std::uint32_t>> matches_ = {{}};  ///< By state.
  bool isTooLarge_ = false;
};

}  // namespace aerosol::render

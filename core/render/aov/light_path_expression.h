// Light path expressions, in the notation of Open Shading Language.
//
// An event is written <TSL>: its type T (C camera, R reflection, T transmission, V volume, L light, B background, O
// what emits without being a light), its scattering S (D diffuse, G glossy, S singular, s straight) and a label L in
// single quotes; what is left out may be anything. A letter alone stands for <T.> or <.S>, a label alone for <..L>,
// '.' for any event, [RT] and [^D] for sets and their complements, also inside < >. Events follow each other from the
// camera to the light; * + ? {n} {n,m} {n,} repeat, | chooses, ( ) group.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/render/aov/light_path_events.h"

namespace aerosol::render {

/// A nondeterministic automaton in Thompson's form ("Regular Expression Search Algorithm", 1968): each state has either
/// one arrow that reads a symbol, or up to two that read nothing.
struct LightPathExpression {
  static constexpr std::int32_t none = -1;

  struct State {
    std::int32_t set = none;  ///< Index into `sets`: the symbols that lead to `next`; none: nothing is read.
    std::int32_t next = none, other = none;
  };
  std::vector<State> states;
  std::vector<std::vector<bool>> sets;  ///< By symbol.
  std::int32_t start = none, end = none;
};

/// What is wrong with an expression, and at which byte.
struct ExpressionProblem {
  std::string message;
  std::size_t at = 0;
};

/// `labels` are those that events may have, the first of them "" for none. False when something is wrong.
bool parseLightPath(std::string_view text, const std::vector<std::string>& labels, LightPathExpression& expression,
                    ExpressionProblem& problem);

}  // namespace aerosol::render

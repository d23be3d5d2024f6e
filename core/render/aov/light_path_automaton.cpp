#include "core/render/aov/light_path_automaton.h"

#include <algorithm>
#include <map>
#include <utility>

namespace aerosol::render {

namespace {

/// States of all expressions together: (expression, state), ascending.
using Subset = std::vector<std::pair<std::uint32_t, std::int32_t>>;

/// With all states that are reached without reading.
void close(std::span<const LightPathExpression> expressions, Subset& subset) {
  for (std::size_t i = 0; i < subset.size(); ++i) {
    const auto [expression, index] = subset[i];
    const auto& state = expressions[expression].states[static_cast<std::size_t>(index)];
    if (state.set != LightPathExpression::none) continue;
    for (const std::int32_t to : {state.next, state.other}) {
      const std::pair<std::uint32_t, std::int32_t> reached{expression, to};
      if (to != LightPathExpression::none && std::find(subset.begin(), subset.end(), reached) == subset.end())
        subset.push_back(reached);
    }
  }
  std::sort(subset.begin(), subset.end());
}

/// Symbols that are in the same sets of all expressions are one class.
std::size_t classify(std::span<const LightPathExpression> expressions, std::size_t symbolCount,
                     std::vector<std::uint32_t>& classes) {
  std::map<std::vector<bool>, std::uint32_t> known;
  classes.resize(symbolCount);
  for (std::size_t symbol = 0; symbol < symbolCount; ++symbol) {
    std::vector<bool> membership;
    for (const LightPathExpression& expression : expressions) {
      for (const auto& set : expression.sets) membership.push_back(set[symbol]);
    }
    classes[symbol] = known.try_emplace(membership, static_cast<std::uint32_t>(known.size())).first->second;
  }
  return known.size();
}

}  // namespace

// The subset construction of Rabin and Scott ("Finite Automata and Their Decision Problems", 1959) over the union of
// all expressions, which keep apart which of them have come to their end.
LightPathAutomaton::LightPathAutomaton(std::span<const LightPathExpression> expressions, std::size_t symbolCount) {
  classCount_ = classify(expressions, symbolCount, classes_);
  std::vector<std::size_t> representative(classCount_);
  for (std::size_t symbol = symbolCount; symbol-- > 0;) representative[classes_[symbol]] = symbol;

  std::map<Subset, State> known = {{Subset{}, dead}};
  std::vector<Subset> subsets = {Subset{}};
  const auto stateOf = [&](Subset subset) {
    close(expressions, subset);
    const auto [at, isNew] = known.try_emplace(subset, static_cast<State>(subsets.size()));
    if (isNew) subsets.push_back(std::move(subset));
    return at->second;
  };
  Subset first;
  for (std::uint32_t i = 0; i < expressions.size(); ++i) first.emplace_back(i, expressions[i].start);
  start_ = stateOf(first);
  arrows_.clear();
  matches_.clear();
  for (std::size_t i = 0; i < subsets.size(); ++i) {
    if (subsets.size() > mostStates) {
      isTooLarge_ = true;
      return;
    }
    std::vector<std::uint32_t> matched;
    for (const auto& [expression, state] : subsets[i]) {
      if (state == expressions[expression].end) matched.push_back(expression);
    }
    matches_.push_back(std::move(matched));
    for (std::size_t c = 0; c < classCount_; ++c) {
      Subset reached;
      for (const auto& [expression, index] : subsets[i]) {
        const auto& state = expressions[expression].states[static_cast<std::size_t>(index)];
        if (state.set == LightPathExpression::none) continue;
        if (!expressions[expression].sets[static_cast<std::size_t>(state.set)][representative[c]]) continue;
        const std::pair<std::uint32_t, std::int32_t> to{expression, state.next};
        if (std::find(reached.begin(), reached.end(), to) == reached.end()) reached.push_back(to);
      }
      arrows_.push_back(stateOf(std::move(reached)));
    }
  }
  minimize();
}

// Moore's partition refinement ("Gedanken-Experiments on Sequential Machines", 1956).
void LightPathAutomaton::minimize() {
  std::vector<State> part(stateCount());
  std::size_t count = 0;
  for (bool isFirst = true;; isFirst = false) {
    // What a state shows: what it matches, then its part and those of its successors.
    std::map<std::pair<std::vector<std::uint32_t>, std::vector<State>>, State> parts;
    std::vector<State> refined(stateCount());
    for (std::size_t state = 0; state < stateCount(); ++state) {
      std::vector<State> shown;
      if (!isFirst) {
        shown.push_back(part[state]);
        for (std::size_t c = 0; c < classCount_; ++c) shown.push_back(part[arrows_[state * classCount_ + c]]);
      }
      refined[state] =
          parts.try_emplace({matches_[state], std::move(shown)}, static_cast<State>(parts.size())).first->second;
    }
    const bool isStable = !isFirst && parts.size() == count;
    count = parts.size();
    part = std::move(refined);
    if (isStable) break;
  }
  // State 0 comes first in every round, so the dead state keeps its number.
  std::vector<State> arrows(count * classCount_);
  std::vector<std::vector<std::uint32_t>> matches(count);
  for (std::size_t state = stateCount(); state-- > 0;) {
    matches[part[state]] = matches_[state];
    for (std::size_t c = 0; c < classCount_; ++c)
      arrows[part[state] * classCount_ + c] = part[arrows_[state * classCount_ + c]];
  }
  arrows_ = std::move(arrows);
  matches_ = std::move(matches);
  start_ = part[start_];
}

}  // namespace aerosol::render

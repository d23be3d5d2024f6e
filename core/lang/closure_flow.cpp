#include "core/lang/closure_flow.h"

#include "core/lang/analysis.h"

namespace aerosol::lang {

void ClosureFlow::run() {
  anywhere_.resize(program_.variables.size());
  follow(program_.body);
}

const Sites& ClosureFlow::at(const Instruction& instruction, std::size_t argument) const {
  static const Sites none;
  const auto known = arguments_.find(&instruction);
  return known == arguments_.end() ? none : known->second[argument];
}

Sites ClosureFlow::atEnd(VariableId variable) const {
  const auto known = state_.find(variable);
  return known == state_.end() ? Sites{} : known->second;
}

void ClosureFlow::join(State& state, const State& other) {
  for (const auto& [variable, sites] : other) state[variable].insert(sites.begin(), sites.end());
}

void ClosureFlow::follow(const Code& code) {
  for (const Instruction& instruction : code) {
    record(instruction);
    if (isClosure(instruction.result)) {
      Sites sites = resultOf(instruction);
      Sites& held = state_[instruction.result];
      if (updatesResult(instruction.op)) {
        held.insert(sites.begin(), sites.end());
      } else {
        held = std::move(sites);
      }
      anywhere_[instruction.result].insert(held.begin(), held.end());
    }
    if (!instruction.bodies.empty() || instruction.op == Op::leave || instruction.op == Op::breakLoop ||
        instruction.op == Op::continueLoop)
      followControl(instruction);
  }
}

void ClosureFlow::record(const Instruction& instruction) {
  bool any = false;
  for (const VariableId argument : instruction.arguments) any = any || isClosure(argument);
  if (!any) return;
  auto& arguments = arguments_[&instruction];
  arguments.resize(instruction.arguments.size());
  for (std::size_t i = 0; i < arguments.size(); ++i)
    if (isClosure(instruction.arguments[i])) arguments[i] = atEnd(instruction.arguments[i]);
}

Sites ClosureFlow::resultOf(const Instruction& instruction) {
  if (instruction.op == Op::closureMake) return {instruction.site};
  Sites result;
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    if (!isClosure(instruction.arguments[i])) continue;
    const Sites& sites = at(instruction, i);
    if (instruction.op != Op::closureLayer) {
      result.insert(sites.begin(), sites.end());
    } else if (i == 0) {
      result = sites;
      tops_[instruction.site].insert(sites.begin(), sites.end());
    } else {
      for (const std::uint32_t site : sites)
        if (const auto below = layerings_.below(site, instruction.site, instruction.location)) result.insert(*below);
    }
  }
  return result;
}

void ClosureFlow::followControl(const Instruction& instruction) {
  switch (instruction.op) {
    case Op::branch: {
      const State before = state_;
      follow(instruction.bodies[0]);
      State after = std::move(state_);
      state_ = before;
      follow(instruction.bodies[1]);
      join(state_, after);
      return;
    }
    case Op::loop:
      followLoop(instruction);
      return;
    case Op::scope:
      follow(instruction.bodies[0]);
      join(state_, scopeExits_[instruction.scopeId]);
      return;
    case Op::leave:
      join(scopeExits_[instruction.scopeId], state_);
      return;
    default:
      if (!loopExits_.empty()) join(loopExits_.back(), state_);
  }
}

void ClosureFlow::followLoop(const Instruction& loop) {
  loopExits_.emplace_back();
  State before;
  do {
    before = state_;
    for (const Code& body : loop.bodies) {
      follow(body);
      join(state_, loopExits_.back());
    }
    join(state_, before);
  } while (before != state_);
  loopExits_.pop_back();
}

}  // namespace aerosol::lang

#include "core/lang/uniformity.h"

#include <algorithm>

#include "core/lang/analysis.h"

namespace aerosol::lang {

namespace {

/// Calls function(variable, isWrite, isWhole) for every access of the instruction itself, reads first.
template <class Function>
void forEachAccess(const Program& program, const Instruction& instruction, Function&& function) {
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    const VariableId argument = instruction.arguments[i];
    if (argument == noVariable) continue;
    if (!writesArgument(program, instruction, i)) function(argument, false, false);
  }
  for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
    // A library function may leave what it is asked to write as it was.
    if (writesArgument(program, instruction, i)) function(instruction.arguments[i], true, false);
  }
  if (instruction.result != noVariable) function(instruction.result, true, !updatesResult(instruction.op));
}

/// The order in which the bodies of a control instruction run.
std::vector<std::size_t> bodyOrder(const Instruction& control) {
  if (control.op != Op::loop) {
    std::vector<std::size_t> order(control.bodies.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    return order;
  }
  return control.testsLast ? std::vector<std::size_t>{1, 2, 0} : std::vector<std::size_t>{0, 1, 2};
}

}  // namespace

bool writesArgument(const Program& program, const Instruction& instruction, std::size_t index) {
  if (instruction.op != Op::call) return false;
  return index < 32 && ((program.functions[instruction.function].outputs >> index) & 1u) != 0;
}

Uniformity::Uniformity(const Program& program, const Code& code, const Inputs& inputs)
    : program_(program), inputs_(inputs) {
  const std::size_t count = program.variables.size();
  accessCounts_.resize(count, 0);
  writeCounts_.resize(count, 0);
  homes_.resize(count);
  varying_.resize(count, false);
  for (VariableId id = 0; id < count; ++id) varying_[id] = inputs.startsVarying(id);
  // Results are read behind the end.
  for (const Output& output : program.outputs) {
    if (output.variable != noVariable) ++accessCounts_[output.variable];
  }
  countAccesses(code);
  findHomes(code, 0);
  do {
    changed_ = false;
    walk(code);
  } while (changed_);
}

void Uniformity::countAccesses(const Code& code) {
  for (const Instruction& instruction : code) {
    // (The condition of a branch or loop is among these.)
    forEachAccess(program_, instruction, [this](VariableId variable, bool isWrite, bool) {
      ++accessCounts_[variable];
      if (isWrite) ++writeCounts_[variable];
    });
    for (const Code& body : instruction.bodies) countAccesses(body);
  }
}

void Uniformity::settle(VariableId variable, Home home) {
  if (homes_[variable].depth == 0) homes_[variable] = home;
}

Uniformity::BlockAccesses Uniformity::findHomes(const Code& code, std::size_t depth) {
  BlockAccesses block;
  for (const Instruction& instruction : code) {
    const auto access = [&](VariableId variable, unsigned count, bool isWholeWrite) {
      Accesses& accesses = block[variable];
      if (accesses.count == 0) accesses.startsWithWrite = isWholeWrite;
      accesses.count += count;
      const bool isBeforeLoop = isWholeWrite && !accesses.onlyLoop;
      if (isBeforeLoop) return;
      if (instruction.op == Op::loop && !accesses.onlyLoop) accesses.onlyLoop = &instruction;
      if (accesses.onlyLoop != &instruction) accesses.usedOutsideLoop = true;
    };
    if (isControl(instruction.op)) {
      for (const auto& [variable, inner] : findHomesInBodies(instruction, depth + 1)) {
        access(variable, inner.count, false);
      }
    } else {
      forEachAccess(program_, instruction,
                    [&](VariableId variable, bool isWrite, bool isWhole) { access(variable, 1, isWrite && isWhole); });
    }
  }
  for (const auto& [variable, accesses] : block) {
    if (accesses.count != accessCounts_[variable] || !accesses.startsWithWrite) continue;
    const bool isLoop = accesses.onlyLoop && !accesses.usedOutsideLoop;
    settle(variable, {isLoop ? depth + 1 : depth, isLoop});
  }
  return block;
}

/// Of a control instruction with all its bodies, which stand at `depth`, and its condition.
Uniformity::BlockAccesses Uniformity::findHomesInBodies(const Instruction& control, std::size_t depth) {
  BlockAccesses all;
  const auto add = [&all](VariableId variable, const Accesses& accesses) {
    const auto [it, isNew] = all.insert({variable, accesses});
    if (!isNew) it->second.count += accesses.count;
  };
  const VariableId condition = control.arguments.empty() ? noVariable : control.arguments[0];
  if (control.op == Op::branch) add(condition, {.count = 1});
  for (const std::size_t body : bodyOrder(control)) {
    for (const auto& [variable, accesses] : findHomes(control.bodies[body], depth)) add(variable, accesses);
    if (control.op == Op::loop && body == 0) add(condition, {.count = 1});
  }
  if (control.op == Op::loop) {
    for (const auto& [variable, accesses] : all) {
      if (accesses.count == accessCounts_[variable] && accesses.startsWithWrite) settle(variable, {depth, true});
    }
  }
  return all;
}

void Uniformity::markVarying(VariableId variable) {
  if (varying_[variable]) return;
  varying_[variable] = true;
  changed_ = true;
}

/// Are some of the points that entered the home absent here, to come back within it?
bool Uniformity::isParted(Home home) const {
  const auto isParting = [](const Construct& construct) {
    return construct.parts || construct.pendingEnd || construct.pendingContinue;
  };
  const std::size_t first = std::min(home.depth, constructs_.size());
  if (std::any_of(constructs_.begin() + static_cast<std::ptrdiff_t>(first), constructs_.end(), isParting)) return true;
  // Those who wait for the next round of a loop come back to what it carries.
  return home.isLoop && home.depth <= constructs_.size() && constructs_[home.depth - 1].pendingContinue;
}

void Uniformity::write(const Instruction& instruction, VariableId variable, bool valueVaries) {
  const Storage storage = program_.variables[variable].storage;
  bool parted = false;
  if (storage == Storage::parameter || storage == Storage::global) {
    parted = isParted({});
  } else if (storage != Storage::temporary || writeCounts_[variable] != 1) {
    parted = isParted(homes_[variable]);
  }
  if (parted) insert(blends_, std::pair(&instruction, variable));
  if (valueVaries || parted) markVarying(variable);
}

bool Uniformity::resultVaries(const Instruction& instruction) const {
  for (const VariableId argument : instruction.arguments) {
    if (argument != noVariable && varying_[argument]) return true;
  }
  if (updatesResult(instruction.op) && varying_[instruction.result]) return true;
  if (instruction.op != Op::call) return false;
  return !program_.functions[instruction.function].pure || inputs_.callVaries(instruction);
}

void Uniformity::walk(const Code& code) {
  for (const Instruction& instruction : code) {
    if (isExit(instruction.op)) {
      walkExit(instruction);
    } else if (isControl(instruction.op)) {
      walkControl(instruction);
    } else {
      const bool varies = resultVaries(instruction);
      forEachAccess(program_, instruction, [&](VariableId variable, bool isWrite, bool) {
        if (isWrite) write(instruction, variable, varies);
      });
    }
  }
}

void Uniformity::walkControl(const Instruction& instruction) {
  const bool hasCondition = instruction.op != Op::scope;
  if (hasCondition && varying_[instruction.arguments[0]]) insert(varyingControl_, &instruction);
  if (instruction.op == Op::loop) {
    // What leaves in one round is absent in the next, from its beginning on.
    for (Construct& outer : constructs_) {
      if (exitsThrough_[&instruction].contains(outer.instruction)) outer.pendingEnd = true;
    }
  }
  constructs_.push_back({&instruction, varyingControl_.contains(&instruction)});
  if (instruction.op == Op::loop) {
    if (isParted({})) insert(unlikeLoops_, &instruction);
    const bool testsFirst = !instruction.testsLast;
    if (testsFirst) walk(instruction.bodies[0]);
    walk(instruction.bodies[1]);
    constructs_.back().pendingContinue = false;
    walk(instruction.bodies[2]);
    if (!testsFirst) walk(instruction.bodies[0]);
  } else {
    // Points that left in the first body are as absent as others in the second, which `parts` covers when it matters;
    // in a branch of all points only one body is run, and what the other leaves pending is pending afterwards.
    const std::vector<Construct> before = constructs_;
    std::vector<Construct> after = constructs_;
    for (const Code& body : instruction.bodies) {
      constructs_ = before;
      walk(body);
      for (std::size_t i = 0; i < after.size(); ++i) {
        after[i].pendingEnd = after[i].pendingEnd || constructs_[i].pendingEnd;
        after[i].pendingContinue = after[i].pendingContinue || constructs_[i].pendingContinue;
      }
    }
    constructs_ = std::move(after);
  }
  constructs_.pop_back();
}

void Uniformity::walkExit(const Instruction& instruction) {
  std::size_t target = constructs_.size();
  while (target > 0) {
    const Instruction& candidate = *constructs_[target - 1].instruction;
    if (instruction.op == Op::leave ? candidate.op == Op::scope && candidate.scopeId == instruction.scopeId
                                    : candidate.op == Op::loop) {
      break;
    }
    --target;
  }
  if (target == 0) return;
  Construct& construct = constructs_[target - 1];
  bool masked = maskedExits_.contains(&instruction);
  for (std::size_t i = target; i < constructs_.size(); ++i) {
    masked = masked || constructs_[i].parts || constructs_[i].pendingEnd || constructs_[i].pendingContinue;
  }
  if (instruction.op == Op::breakLoop) masked = masked || construct.pendingContinue;
  if (!masked) return;
  insert(maskedExits_, &instruction);
  if (instruction.op == Op::continueLoop) {
    construct.pendingContinue = true;
  } else {
    construct.pendingEnd = true;
    if (instruction.op == Op::breakLoop) {
      construct.parts = true;
      insert(varyingControl_, construct.instruction);
    }
  }
  // Loops that are left on the way have points absent in all their later rounds.
  if (instruction.op != Op::continueLoop) {
    for (std::size_t i = target; i < constructs_.size(); ++i) {
      if (constructs_[i].instruction->op != Op::loop) continue;
      insert(exitsThrough_[constructs_[i].instruction], construct.instruction);
    }
  }
}

}  // namespace aerosol::lang

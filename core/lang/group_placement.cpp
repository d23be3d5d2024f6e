#include "core/lang/group_placement.h"

#include <algorithm>

#include "core/lang/analysis.h"
#include "core/lang/uniformity.h"

namespace aerosol::lang {

namespace {

constexpr std::uint32_t markerScope = 0xffffffffu;
/// Beyond so many instructions in copies, a layer has one place even if it leaves messages.
constexpr std::size_t maximumCopied = 20000;
/// Blocks around a layer's code; deeper programs cost the stack of every pass over them.
constexpr int maximumBlockDepth = 100;

bool matchesWithin(const Instruction& instruction, const Matcher& matches) {
  const Match match = matches(instruction);
  if (match != Match::no) return match == Match::yes;
  for (const Code& body : instruction.bodies)
    for (const Instruction& inner : body)
      if (matchesWithin(inner, matches)) return true;
  return false;
}

std::size_t countInstructions(const Code& code) {
  std::size_t count = 0;
  forEachInstruction(code, [&](const Instruction&) { ++count; });
  return count;
}

bool leaves(const Code& code, std::uint32_t scopeId) {
  bool found = false;
  forEachInstruction(code, [&](const Instruction& instruction) {
    found = found || (instruction.op == Op::leave && instruction.scopeId == scopeId);
  });
  return found;
}

}  // namespace

bool insertBeforeAll(Code& code, const Matcher& matches, Code added, int maximumDepth) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < code.size() && found.size() < 2; ++i)
    if (matchesWithin(code[i], matches)) found.push_back(i);
  if (found.empty()) return false;
  Instruction& first = code[found[0]];
  if (found.size() == 1 && maximumDepth > 0 && matches(first) == Match::no && first.op != Op::loop) {
    Code* only = nullptr;
    int count = 0;
    for (Code& body : first.bodies) {
      const bool inside = std::any_of(body.begin(), body.end(),
                                      [&](const Instruction& inner) { return matchesWithin(inner, matches); });
      if (inside) {
        only = &body;
        ++count;
      }
    }
    if (count == 1) return insertBeforeAll(*only, matches, std::move(added), maximumDepth - 1);
  }
  code.insert(code.begin() + static_cast<std::ptrdiff_t>(found[0]), std::make_move_iterator(added.begin()),
              std::make_move_iterator(added.end()));
  return true;
}

LayerPlacement::LayerPlacement(Program& program, std::vector<LayerCode> layers, std::vector<Index> producers)
    : program_(program), layers_(std::move(layers)), producers_(std::move(producers)) {
  top_ = static_cast<Index>(layers_.size());
  layers_.emplace_back();
  const std::size_t count = layers_.size();
  reads_.resize(count);
  users_.resize(count);
  hosts_.assign(count, noLayer);
  hostDepth_.assign(count, 0);
  blockDepth_.assign(count, 0);
  copies_.assign(count, 1);
  expanded_.assign(count, 0);
  for (const LayerCode& layer : layers_) sizes_.push_back(countInstructions(layer.code));
}

Code LayerPlacement::run() {
  findReads();
  findHosts();
  for (Index layer = 0; layer < top_; ++layer)
    if (layers_[layer].alwaysRuns) layers_[top_].code.push_back(marker(layer));
  for (Index layer = top_; layer-- > 0;)
    if (hosts_[layer] != noLayer && !layers_[layer].alwaysRuns) place(layer);
  Code whole;
  expand(layers_[top_].code, nullptr, whole);
  return whole;
}

void LayerPlacement::findReads() {
  for (Index layer = 0; layer < top_; ++layer) {
    const auto read = [&](VariableId id) {
      if (id == noVariable || id >= producers_.size()) return;
      if (producers_[id] != noLayer && producers_[id] != layer) reads_[layer].insert(producers_[id]);
    };
    forEachInstruction(layers_[layer].code, [&](const Instruction& instruction) {
      for (const VariableId argument : instruction.arguments) read(argument);
    });
  }
}

/// Hosts are immediate dominators: connections lead to higher numbers, so one pass from the last layer finds them.
void LayerPlacement::findHosts() {
  for (Index layer = top_; layer-- > 0;) {
    if (layers_[layer].alwaysRuns) {
      hosts_[layer] = top_;
    } else {
      for (const Index user : users_[layer])
        hosts_[layer] = hosts_[layer] == noLayer ? user : commonHost(hosts_[layer], user);
    }
    if (hosts_[layer] == noLayer) continue;
    hostDepth_[layer] = hostDepth_[hosts_[layer]] + 1;
    for (const Index source : reads_[layer]) users_[source].insert(layer);
  }
}

LayerPlacement::Index LayerPlacement::commonHost(Index a, Index b) const {
  while (a != b) {
    if (hostDepth_[a] >= hostDepth_[b]) {
      a = hosts_[a];
    } else {
      b = hosts_[b];
    }
  }
  return a;
}

bool LayerPlacement::readsDirectly(const Instruction& instruction) const {
  return std::any_of(instruction.arguments.begin(), instruction.arguments.end(),
                     [&](VariableId id) { return id < producers_.size() && producers_[id] == current_; });
}

bool LayerPlacement::isMarker(const Instruction& instruction) {
  return instruction.op == Op::scope && instruction.scopeId == markerScope;
}

Instruction LayerPlacement::marker(Index layer) const {
  Instruction instruction;
  instruction.op = Op::scope;
  instruction.scopeId = markerScope;
  instruction.function = layer;
  if (!layers_[layer].code.empty()) instruction.location = layers_[layer].code.front().location;
  return instruction;
}

bool LayerPlacement::uses(const Instruction& instruction) const {
  if (isMarker(instruction)) return leadsToUse_[instruction.function];
  if (readsDirectly(instruction)) return true;
  for (const Code& body : instruction.bodies)
    if (std::any_of(body.begin(), body.end(), [&](const Instruction& inner) { return uses(inner); })) return true;
  return false;
}

void LayerPlacement::place(Index layer) {
  current_ = layer;
  const Index host = hosts_[layer];
  leadsToUse_.assign(layers_.size(), false);
  for (Index user : users_[layer])
    for (; user != host && !leadsToUse_[user]; user = hosts_[user]) leadsToUse_[user] = true;
  copies_[layer] = copies_[host];
  blockDepth_[layer] = blockDepth_[host];
  if (!layers_[layer].isMovable) {
    isTrial_ = true;
    walked_.assign(layers_.size(), false);
    exits_.assign(layers_.size(), State::no);
    sites_ = 0;
    deepest_ = 0;
    needsFlag_ = false;
    walk(host, layers_[host].code, State::no, blockDepth_[host]);
    if (sites_ == 1 || (sites_ * sizes_[layer] <= maximumCopied && deepest_ < maximumBlockDepth)) {
      placeExactly(layer);
      return;
    }
  }
  const Matcher matches = [&](const Instruction& instruction) {
    if (isMarker(instruction)) return leadsToUse_[instruction.function] ? Match::yes : Match::no;
    return readsDirectly(instruction) ? Match::yes : Match::no;
  };
  insertBeforeAll(layers_[host].code, matches, {marker(layer)}, std::max(0, maximumBlockDepth - blockDepth_[host]));
  // How deep it went is not known from here; every chain of hosts adds what it can add at most.
  blockDepth_[layer] = blockDepth_[host];
  int depth = 0;
  const auto find = [&](const auto& self, const Code& code, int at) -> void {
    for (const Instruction& instruction : code) {
      if (isMarker(instruction) && instruction.function == layer) depth = at;
      for (const Code& body : instruction.bodies) self(self, body, at + 1);
    }
  };
  find(find, layers_[host].code, blockDepth_[host]);
  blockDepth_[layer] = depth;
}

void LayerPlacement::placeExactly(Index layer) {
  const Index host = hosts_[layer];
  isTrial_ = false;
  walked_.assign(layers_.size(), false);
  copies_[layer] = sites_;
  blockDepth_[layer] = deepest_;
  hasRun_ = noVariable;
  if (needsFlag_) {
    Variable flag;
    flag.type = types::integer;
    flag.storage = Storage::local;
    program_.variables.push_back(std::move(flag));
    hasRun_ = static_cast<VariableId>(program_.variables.size() - 1);
  }
  walk(host, layers_[host].code, State::no, blockDepth_[host]);
}

VariableId LayerPlacement::one() {
  if (one_ == noVariable) {
    Variable variable;
    variable.type = types::integer;
    variable.storage = Storage::constant;
    variable.value = std::vector<std::int32_t>{1};
    program_.variables.push_back(std::move(variable));
    one_ = static_cast<VariableId>(program_.variables.size() - 1);
  }
  return one_;
}

/// Sees to it that the current layer has been run when control reaches `code[at]`, which stands in the code of `layer`.
LayerPlacement::State LayerPlacement::ensure(Index layer, Code& code, std::size_t& at, State state, int depth) {
  if (state == State::yes) return state;
  if (isTrial_) {
    sites_ += copies_[layer];
    needsFlag_ = needsFlag_ || state == State::maybe;
    deepest_ = std::max(deepest_, depth + (state == State::maybe ? 1 : 0));
    return State::yes;
  }
  Code added = {marker(current_)};
  if (needsFlag_) {
    Instruction set;
    set.op = Op::assign;
    set.result = hasRun_;
    set.arguments = {one()};
    set.location = added[0].location;
    added.push_back(std::move(set));
  }
  if (state == State::maybe) {
    Instruction branch;
    branch.op = Op::branch;
    branch.arguments = {hasRun_};
    branch.location = added[0].location;
    branch.bodies = {{}, std::move(added)};
    added = {std::move(branch)};
  }
  const std::size_t count = added.size();
  code.insert(code.begin() + static_cast<std::ptrdiff_t>(at), std::make_move_iterator(added.begin()),
              std::make_move_iterator(added.end()));
  at += count;
  return State::yes;
}

/// Follows control through code of `layer`; `state` tells whether the current layer has been run before, `no` and `yes`
/// being certain.
LayerPlacement::State LayerPlacement::walk(Index layer, Code& code, State state, int depth) {
  const auto join = [](State a, State b) { return a == b ? a : State::maybe; };
  for (std::size_t at = 0; at < code.size() && state != State::yes; ++at) {
    if (!uses(code[at])) continue;
    if (isMarker(code[at])) {
      state = walkLayer(code[at].function, state, depth);
      continue;
    }
    if (readsDirectly(code[at])) state = ensure(layer, code, at, state, depth);
    Instruction& instruction = code[at];
    if (instruction.bodies.empty() || state == State::yes) continue;
    switch (instruction.op) {
      case Op::branch: {
        const State yes = walk(layer, instruction.bodies[0], state, depth + 1);
        const State no = walk(layer, instruction.bodies[1], state, depth + 1);
        state = join(yes, no);
        break;
      }
      case Op::scope: {
        const State end = walk(layer, instruction.bodies[0], state, depth + 1);
        state = leaves(instruction.bodies[0], instruction.scopeId) ? join(state, end) : end;
        break;
      }
      default:
        for (Code& body : instruction.bodies) walk(layer, body, State::maybe, depth + 1);
        state = State::maybe;
        break;
    }
  }
  return state;
}

LayerPlacement::State LayerPlacement::walkLayer(Index layer, State state, int depth) {
  if (!walked_[layer]) {
    walked_[layer] = true;
    exits_[layer] = walk(layer, layers_[layer].code, copies_[layer] > copies_[hosts_[current_]] ? State::maybe : state,
                         std::max(depth, blockDepth_[layer]));
  }
  return exits_[layer];
}

/// Code with the layers in place of their markers. Temporaries are written once, so that copies have their own.
void LayerPlacement::expand(const Code& code, std::vector<VariableId>* renamed, Code& out) {
  const auto own = [&](VariableId id) {
    if (!renamed || id == noVariable || program_.variables[id].storage != Storage::temporary) return id;
    if (renamed->size() <= id) renamed->resize(program_.variables.size(), noVariable);
    if ((*renamed)[id] == noVariable) {
      (*renamed)[id] = static_cast<VariableId>(program_.variables.size());
      program_.variables.push_back(Variable(program_.variables[id]));
    }
    return (*renamed)[id];
  };
  for (const Instruction& instruction : code) {
    if (isMarker(instruction)) {
      std::vector<VariableId> names;
      const bool isCopy = expanded_[instruction.function]++ > 0;
      expand(layers_[instruction.function].code, isCopy ? &names : nullptr, out);
      continue;
    }
    Instruction copy = instruction;
    copy.result = own(copy.result);
    for (VariableId& argument : copy.arguments) argument = own(argument);
    for (std::size_t i = 0; i < copy.bodies.size(); ++i) {
      copy.bodies[i].clear();
      expand(instruction.bodies[i], renamed, copy.bodies[i]);
    }
    out.push_back(std::move(copy));
  }
}

}  // namespace aerosol::lang

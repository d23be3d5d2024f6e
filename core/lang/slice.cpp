#include <algorithm>
#include <unordered_set>

#include "core/lang/analysis.h"

namespace aerosol::lang {

namespace {

/// Marks what is needed, backwards from the outputs, without regard to order: an instruction is needed when it writes a
/// variable that is needed; control is needed when something in it is; jumps are needed when what they leave is.
class Slicer {
 public:
  Slicer(const Program& program, Messages messages)
      : program_(program), keepsMessages_(messages == Messages::keep), needed_(program.variables.size(), false) {}

  Program run(std::span<const Output> outputs) {
    for (const Output& output : outputs) need(output.variable);
    do {
      changed_ = false;
      visit(program_.body);
    } while (changed_);
    Program result = program_;
    result.outputs.assign(outputs.begin(), outputs.end());
    result.body = keep(program_.body);
    if (result.ci != noVariable && !needed_[result.ci]) result.ci = noVariable;
    renumber(result);
    return result;
  }

 private:
  void need(VariableId id) {
    if (id == noVariable || needed_[id]) return;
    needed_[id] = true;
    changed_ = true;
  }

  /// Whether the instruction itself must stay; bodies were visited before.
  bool isNeeded(const Instruction& instruction) {
    switch (instruction.op) {
      case Op::message:
        return keepsMessages_;
      case Op::branch:
      case Op::loop:
      case Op::scope:
        return bodiesNeeded(instruction);
      case Op::breakLoop:
      case Op::continueLoop:
        return !loops_.empty() && kept_.contains(loops_.back());
      case Op::leave: {
        const auto scope = std::find_if(scopes_.rbegin(), scopes_.rend(), [&](const Instruction* known) {
          return known->scopeId == instruction.scopeId;
        });
        return scope != scopes_.rend() && kept_.contains(*scope);
      }
      default: {
        bool written = false;
        forEachWritten(program_, instruction, [&](VariableId id) { written = written || needed_[id]; });
        return written || (readsMessages_ && (traitsOf(instruction) & writesMessages) != 0) ||
               (keepsMessages_ && changesWorld(instruction));
      }
    }
  }

  /// Like a message, what the host keeps is a result nobody in the program reads.
  bool changesWorld(const Instruction& instruction) const {
    if (instruction.op != Op::call) return false;
    const FunctionUse& function = program_.functions[instruction.function];
    return function.host && !function.pure;
  }

  std::uint8_t traitsOf(const Instruction& instruction) const {
    return instruction.op == Op::call ? program_.functions[instruction.function].traits : std::uint8_t{0};
  }

  bool bodiesNeeded(const Instruction& instruction) const {
    return std::any_of(instruction.bodies.begin(), instruction.bodies.end(),
                       [&](const Code& body) { return codeNeeded(body); });
  }
  bool codeNeeded(const Code& code) const {
    return std::any_of(code.begin(), code.end(),
                       [&](const Instruction& instruction) { return kept_.contains(&instruction); });
  }

  void visit(const Code& code) {
    for (auto instruction = code.rbegin(); instruction != code.rend(); ++instruction) {
      if (instruction->op == Op::loop) loops_.push_back(&*instruction);
      if (instruction->op == Op::scope) scopes_.push_back(&*instruction);
      for (const Code& body : instruction->bodies) visit(body);
      if (instruction->op == Op::loop) loops_.pop_back();
      if (instruction->op == Op::scope) scopes_.pop_back();
      if (!kept_.contains(&*instruction) && isNeeded(*instruction)) {
        kept_.insert(&*instruction);
        changed_ = true;
        for (const VariableId argument : instruction->arguments) need(argument);
        readsMessages_ = readsMessages_ || (traitsOf(*instruction) & readsMessages) != 0;
        if (updatesResult(instruction->op)) need(instruction->result);
      }
    }
  }

  Code keep(const Code& code) const {
    Code result;
    for (const Instruction& instruction : code) {
      if (!kept_.contains(&instruction)) continue;
      Instruction copy = instruction;
      for (Code& body : copy.bodies) body.clear();
      for (std::size_t i = 0; i < copy.bodies.size(); ++i) copy.bodies[i] = keep(instruction.bodies[i]);
      result.push_back(std::move(copy));
    }
    return result;
  }

  void markUsed(const Code& code, std::vector<bool>& used) const {
    forEachInstruction(code, [&](const Instruction& instruction) {
      if (instruction.result != noVariable) used[instruction.result] = true;
      for (const VariableId argument : instruction.arguments) used[argument] = true;
    });
  }

  void renumber(Program& program) const;

  const Program& program_;
  const bool keepsMessages_;
  std::vector<bool> needed_;  ///< By variable.
  std::unordered_set<const Instruction*> kept_;
  std::vector<const Instruction*> loops_, scopes_;  ///< Around the current instruction.
  bool readsMessages_ = false;                      ///< Something that is kept reads what setmessage left.
  bool changed_ = false;
};

template <class Map>
void renumberCode(Code& code, const Map& variables, const std::vector<std::uint32_t>& functions) {
  for (Instruction& instruction : code) {
    if (instruction.result != noVariable) instruction.result = variables[instruction.result];
    for (VariableId& argument : instruction.arguments) argument = variables[argument];
    if (instruction.op == Op::call) instruction.function = functions[instruction.function];
    for (Code& body : instruction.bodies) renumberCode(body, variables, functions);
  }
}

void Slicer::renumber(Program& program) const {
  std::vector<bool> used(program.variables.size(), false);
  std::vector<bool> usedFunctions(program.functions.size(), false);
  markUsed(program.body, used);
  for (const Output& output : program.outputs)
    if (output.variable != noVariable) used[output.variable] = true;
  forEachInstruction(program.body, [&](const Instruction& instruction) {
    if (instruction.op == Op::call) usedFunctions[instruction.function] = true;
  });
  std::vector<VariableId> variables(used.size(), noVariable);
  std::vector<Variable> keptVariables;
  for (VariableId id = 0; id < used.size(); ++id) {
    if (!used[id]) continue;
    variables[id] = static_cast<VariableId>(keptVariables.size());
    keptVariables.push_back(std::move(program.variables[id]));
  }
  std::vector<std::uint32_t> functions(usedFunctions.size(), 0);
  std::vector<FunctionUse> keptFunctions;
  for (std::size_t i = 0; i < usedFunctions.size(); ++i) {
    if (!usedFunctions[i]) continue;
    functions[i] = static_cast<std::uint32_t>(keptFunctions.size());
    keptFunctions.push_back(std::move(program.functions[i]));
  }
  // Closure sites keep their numbers: outputs are named by them.
  renumberCode(program.body, variables, functions);
  const auto renumbered = [&](VariableId id) { return id == noVariable ? noVariable : variables[id]; };
  for (Output& output : program.outputs) output.variable = renumbered(output.variable);
  for (Parameter& parameter : program.parameters) {
    parameter.variable = renumbered(parameter.variable);
    parameter.isSet = renumbered(parameter.isSet);
    parameter.isConnected = renumbered(parameter.isConnected);
  }
  program.ci = renumbered(program.ci);
  program.variables = std::move(keptVariables);
  program.functions = std::move(keptFunctions);
}

}  // namespace

Program slice(const Program& program, std::span<const Output> outputs, Messages messages) {
  return Slicer(program, messages).run(outputs);
}

}  // namespace aerosol::lang

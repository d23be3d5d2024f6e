#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/lang/analysis.h"
#include "core/lang/fold.h"
#include "core/lang/magnitude.h"
#include "core/lang/pure_functions.h"

namespace aerosol::lang {

namespace {

/// What is known of written variables at one point of the program: another variable (a constant, or one that is never
/// written) that has the same value.
using Known = std::unordered_map<VariableId, VariableId>;

/// One walk over the code in the order in which it runs. Facts about temporaries hold wherever these can be read; facts
/// about other variables are forgotten where paths with different facts meet.
class Specialiser {
 public:
  Specialiser(const Program& program, const ParameterValues& values) : program_(program) {
    writes_.assign(program.variables.size(), 0);
    forEachInstruction(program.body, [&](const Instruction& instruction) {
      forEachWritten(program, instruction, [&](VariableId id) { ++writes_[id]; });
    });
    temporaries_.assign(program.variables.size(), noVariable);
    for (VariableId id = 0; id < program.variables.size(); ++id) {
      const Variable& variable = program.variables[id];
      if (variable.storage == Storage::constant) constants_.emplace(bitsKey({variable.type, variable.value}), id);
      const bool startsZero = variable.storage == Storage::local && !variable.type.closure;
      if (startsZero && leafCount(variable.type) <= foldedLeaves) known_[id] = constant(zeroConstant(variable.type));
    }
    for (const auto& [index, value] : values) give(index, value);
  }

  Program run() {
    Code body = std::move(start_);
    walk(program_.body, body);
    for (Output& output : program_.outputs) output.variable = resolve(output.variable);
    program_.body = std::move(body);
    return std::move(program_);
  }

 private:
  void give(std::uint32_t index, const ConstantValue& value) {
    const Parameter& parameter = program_.parameters.at(index);
    const bool isGiven = !std::holds_alternative<std::monostate>(value);
    if (parameter.isSet != noVariable) known_[parameter.isSet] = constant(Constant::ofInt(isGiven ? 1 : 0));
    if (!isGiven && !parameter.hasConstantDefault) return;
    if (parameter.variable == noVariable) return;
    const VariableId fixed = constant({parameter.type, isGiven ? value : parameter.defaultValue});
    known_[parameter.variable] = fixed;
    if (writes_[parameter.variable] == 0) return;
    // The program writes it on some paths: what it holds on the others must be there too.
    Instruction instruction;
    instruction.op = Op::assign;
    instruction.result = parameter.variable;
    instruction.arguments = {fixed};
    start_.push_back(std::move(instruction));
  }

  // Variables

  VariableId constant(const Constant& value) {
    const auto [known, isNew] = constants_.emplace(bitsKey(value), noVariable);
    if (isNew) {
      Variable variable;
      variable.type = value.type;
      variable.storage = Storage::constant;
      variable.value = value.value;
      known->second = add(std::move(variable));
    }
    return known->second;
  }

  VariableId add(Variable variable) {
    program_.variables.push_back(std::move(variable));
    temporaries_.push_back(noVariable);
    writes_.push_back(0);
    return static_cast<VariableId>(program_.variables.size() - 1);
  }

  VariableId resolve(VariableId id) const {
    if (id == noVariable) return id;
    if (temporaries_[id] != noVariable) return temporaries_[id];
    const auto found = known_.find(id);
    return found == known_.end() ? id : found->second;
  }
  bool isConstant(VariableId id) const { return program_.variables[id].storage == Storage::constant; }
  Constant valueOf(VariableId id) const { return {program_.variables[id].type, program_.variables[id].value}; }
  bool isTemporary(VariableId id) const { return program_.variables[id].storage == Storage::temporary; }
  /// May `source` stand for `target` from here on? A temporary may for a temporary only: what else is assigned can be
  /// read outside of the block of the temporary.
  bool mayStandFor(VariableId source, VariableId target) const {
    return isConstant(source) || writes_[source] == 0 || (isTemporary(source) && isTemporary(target));
  }

  void forget(VariableId id) { known_.erase(id); }
  void forgetWritten(const Code& code) {
    forEachInstruction(code, [&](const Instruction& instruction) {
      forEachWritten(program_, instruction, [&](VariableId id) { forget(id); });
    });
  }
  void keepCommon(const Known& other) {
    std::erase_if(known_, [&](const auto& fact) {
      const auto same = other.find(fact.first);
      return same == other.end() || same->second != fact.second;
    });
  }

  // Instructions

  /// True when control never reaches the code's end.
  bool walk(const Code& code, Code& out) {
    for (const Instruction& instruction : code)
      if (step(instruction, out)) return true;
    return false;
  }

  bool step(const Instruction& instruction, Code& out) {
    switch (instruction.op) {
      case Op::branch:
        return branch(instruction, out);
      case Op::loop:
        return loop(instruction, out);
      case Op::scope:
        return scope(instruction, out);
      case Op::breakLoop:
      case Op::continueLoop:
      case Op::leave:
        out.push_back(instruction);
        return true;
      default:
        plain(instruction, out);
        return false;
    }
  }

  bool branch(const Instruction& instruction, Code& out) {
    const VariableId condition = resolve(instruction.arguments[0]);
    if (isConstant(condition)) return walk(instruction.bodies[valueOf(condition).asInt() != 0 ? 0 : 1], out);
    Instruction copy = instruction;
    copy.arguments[0] = condition;
    const Known before = known_;
    copy.bodies[0].clear();
    const bool yesEnds = walk(instruction.bodies[0], copy.bodies[0]);
    Known afterYes = std::exchange(known_, before);
    copy.bodies[1].clear();
    const bool noEnds = walk(instruction.bodies[1], copy.bodies[1]);
    if (noEnds) {
      known_ = std::move(afterYes);
    } else if (!yesEnds) {
      keepCommon(afterYes);
    }
    if (!copy.bodies[0].empty() || !copy.bodies[1].empty()) out.push_back(std::move(copy));
    return yesEnds && noEnds;
  }

  bool loop(const Instruction& instruction, Code& out) {
    for (const Code& body : instruction.bodies) forgetWritten(body);
    const Known before = known_;
    Instruction copy = instruction;
    for (std::size_t i = 0; i < copy.bodies.size(); ++i) {
      copy.bodies[i].clear();
      // A jump may lead past the end of the body: what is known there is what was known before the loop.
      if (i > 0) known_ = before;
      walk(instruction.bodies[i], copy.bodies[i]);
      if (i == 0) {
        copy.arguments[0] = resolve(instruction.arguments[0]);
        const bool never = isConstant(copy.arguments[0]) && valueOf(copy.arguments[0]).asInt() == 0;
        if (never && !instruction.testsLast) {
          std::move(copy.bodies[0].begin(), copy.bodies[0].end(), std::back_inserter(out));
          return false;
        }
      }
    }
    known_ = before;
    for (const Code& body : instruction.bodies) forgetWritten(body);
    out.push_back(std::move(copy));
    return false;
  }

  bool scope(const Instruction& instruction, Code& out) {
    Instruction copy = instruction;
    copy.bodies[0].clear();
    const bool ends = walk(instruction.bodies[0], copy.bodies[0]);
    bool isLeft = false;
    forEachInstruction(copy.bodies[0], [&](const Instruction& inner) {
      isLeft = isLeft || (inner.op == Op::leave && inner.scopeId == instruction.scopeId);
    });
    if (!isLeft) {
      std::move(copy.bodies[0].begin(), copy.bodies[0].end(), std::back_inserter(out));
      return ends;
    }
    forgetWritten(instruction.bodies[0]);
    out.push_back(std::move(copy));
    return false;
  }

  /// No larger arrays are followed element by element.
  static constexpr std::size_t foldedLeaves = 64;

  void plain(const Instruction& instruction, Code& out) {
    Instruction copy = instruction;
    const std::uint32_t outputs = copy.op == Op::call ? program_.functions[copy.function].outputs : 0;
    for (std::size_t i = 0; i < copy.arguments.size(); ++i)
      if (i >= 32 || (outputs >> i & 1u) == 0) copy.arguments[i] = resolve(copy.arguments[i]);
    if (foldOutputs(copy, out)) return;
    const std::optional<VariableId> value = result(copy);
    if (!value) {
      keepName(copy, instruction.arguments);
      readTable(copy);
    }
    forEachWritten(program_, copy, [&](VariableId id) { forget(id); });
    if (copy.result == noVariable) {
      out.push_back(std::move(copy));
      return;
    }
    if (!value || !mayStandFor(*value, copy.result)) {
      if (isTemporary(copy.result)) {
        magnitudes_[copy.result] = measure(copy);
        if (copy.op == Op::element) elements_[copy.result] = copy;
      }
      out.push_back(std::move(copy));
      return;
    }
    if (updatesResult(copy.op) && program_.variables[copy.result].type.isArray()) {
      known_[copy.result] = *value;  // One element is written, not all.
      out.push_back(std::move(copy));
      return;
    }
    settle(copy, *value, out);
  }

  /// The instruction's result has that value.
  void settle(Instruction instruction, VariableId value, Code& out) {
    if (isTemporary(instruction.result)) {
      temporaries_[instruction.result] = value;
      return;
    }
    known_[instruction.result] = value;
    instruction.op = Op::assign;
    instruction.arguments = {value};
    out.push_back(std::move(instruction));
  }

  /// A function of the host that depends on its arguments alone and writes some of them: split, regex_match …
  bool foldOutputs(const Instruction& instruction, Code& out) {
    if (instruction.op != Op::call) return false;
    const FunctionUse& function = program_.functions[instruction.function];
    if (!function.host || !function.dependsOnArgumentsAlone() || function.outputs == 0) return false;
    if (instruction.arguments.size() > 32) return false;
    std::vector<Constant> values;
    for (const VariableId argument : instruction.arguments) {
      const VariableId known = resolve(argument);
      if (!isConstant(known) || leafCount(program_.variables[known].type) > foldedLeaves) return false;
      values.push_back(valueOf(known));
      values.back().type = program_.variables[argument].type;
    }
    const bool hasResult = instruction.result != noVariable;
    const Type type = hasResult ? program_.variables[instruction.result].type : types::none;
    const auto folded = evaluateCall(function.symbol, type, values, function.outputs);
    if (!folded) return false;
    const std::uint32_t outputs = function.outputs;
    Instruction assignment = instruction;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if ((outputs >> i & 1u) == 0) continue;
      assignment.result = instruction.arguments[i];
      settle(assignment, constant(values[i]), out);
    }
    if (!hasResult) return true;
    assignment.result = instruction.result;
    settle(assignment, constant(*folded), out);
    return true;
  }

  /// What is asked of a string out of a constant array is asked of all its elements now, and read from a table of the
  /// answers: `name == "swirl"` and `strlen(name)` cost no more than an index.
  void readTable(Instruction& instruction) {
    if (instruction.op != Op::call && instruction.op != Op::equal && instruction.op != Op::notEqual &&
        instruction.op != Op::toBool)
      return;
    if (instruction.result == noVariable || program_.variables[instruction.result].type.isArray()) return;
    const Instruction* read = nullptr;
    std::size_t place = 0;
    for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
      if (isConstant(instruction.arguments[i])) continue;
      const auto element = elements_.find(instruction.arguments[i]);
      if (read || element == elements_.end()) return;
      read = &element->second;
      place = i;
    }
    if (!read || !isConstant(read->arguments[0])) return;
    const VariableId index = read->arguments[1];
    const Variable& array = program_.variables[read->arguments[0]];
    const auto* texts = std::get_if<std::vector<std::string>>(&array.value);
    if (!texts || texts->size() > foldedLeaves || (!isTemporary(index) && writes_[index] != 0)) return;
    Instruction asked = instruction;
    const std::vector<std::string> elements = *texts;
    Constant table =
        zeroConstant(program_.variables[instruction.result].type.arrayOf(static_cast<int>(elements.size())));
    for (std::size_t i = 0; i < elements.size(); ++i) {
      asked.arguments[place] = constant(Constant::ofString(elements[i]));
      const auto answer = result(asked);
      if (!answer || !isConstant(*answer)) return;
      setElement(table, i, valueOf(*answer));
    }
    instruction.op = Op::element;
    instruction.function = 0;
    instruction.quiet = true;
    instruction.arguments = {constant(table), index};
  }

  /// Reports of indices out of range name what was indexed, though a constant stands for it now.
  void keepName(Instruction& instruction, const std::vector<VariableId>& original) {
    const bool reads =
        instruction.op == Op::component || instruction.op == Op::matrixElement || instruction.op == Op::element;
    if (!reads || instruction.arguments[0] == original[0] || !isConstant(instruction.arguments[0])) return;
    const std::string name = program_.variables[original[0]].name;
    if (name.empty() || name == program_.variables[instruction.arguments[0]].name) return;
    const auto [known, isNew] = named_.emplace(std::pair{instruction.arguments[0], name}, noVariable);
    if (isNew) {
      Variable variable = program_.variables[instruction.arguments[0]];
      variable.name = name;
      known->second = add(std::move(variable));
    }
    instruction.arguments[0] = known->second;
  }

  /// A variable that has the value of the instruction's result.
  std::optional<VariableId> result(const Instruction& instruction) {
    if (instruction.result == noVariable) return std::nullopt;
    const Type type = program_.variables[instruction.result].type;
    if (instruction.op == Op::call) return hostCall(instruction, type);
    const auto& arguments = instruction.arguments;
    if (instruction.op == Op::assign || instruction.op == Op::select) return choice(instruction, type);
    std::vector<Constant> values;
    for (const VariableId argument : arguments)
      if (isConstant(argument)) values.push_back(valueOf(argument));
    if (values.size() != arguments.size()) return identity(instruction, type);
    std::vector<const Constant*> pointers;
    for (const Constant& value : values) pointers.push_back(&value);
    std::optional<Constant> previous;
    if (updatesResult(instruction.op)) {
      const VariableId before = resolve(instruction.result);
      if (!isConstant(before)) return std::nullopt;
      previous = valueOf(before);
    }
    const auto folded = foldOperation(instruction.op, type, pointers, previous ? &*previous : nullptr);
    if (!folded) return std::nullopt;
    return constant(*folded);
  }

  /// A function of the host that depends on its arguments alone.
  std::optional<VariableId> hostCall(const Instruction& instruction, const Type& type) {
    const FunctionUse& function = program_.functions[instruction.function];
    if (!function.host || !function.dependsOnArgumentsAlone() || function.outputs != 0) return std::nullopt;
    std::vector<Constant> values;
    for (const VariableId argument : instruction.arguments) {
      if (!isConstant(argument)) return std::nullopt;
      values.push_back(valueOf(argument));
    }
    const auto folded = evaluateCall(function.symbol, type, values, 0);
    return folded ? std::optional(constant(*folded)) : std::nullopt;
  }

  std::optional<VariableId> choice(const Instruction& instruction, const Type& type) {
    VariableId source = instruction.arguments[0];
    if (instruction.op == Op::select) {
      if (!isConstant(source)) return std::nullopt;
      source = instruction.arguments[valueOf(source).asInt() != 0 ? 1 : 2];
    }
    const bool sameType = program_.variables[source].type == type;
    if (isConstant(source)) return sameType ? source : constant({type, valueOf(source).value});
    return sameType ? std::optional(source) : std::nullopt;
  }

  double magnitude(VariableId id) const {
    const auto known = magnitudes_.find(id);
    if (known != magnitudes_.end()) return known->second;
    return writes_[id] == 0 ? magnitudeOf(program_.variables[id]) : std::numeric_limits<double>::infinity();
  }
  double measure(const Instruction& instruction) const {
    std::vector<double> arguments;
    for (const VariableId argument : instruction.arguments) arguments.push_back(magnitude(argument));
    return magnitudeOf(program_, instruction, arguments);
  }

  /// The constant c of c + x, c - x or x + c where x is so small, or so surely 0, that the sum is c: a term of weight 0
  /// costs nothing, and what is constant but for it is known to be constant.
  std::optional<VariableId> absorbed(const Instruction& instruction, const Type& type) {
    const bool isSum = instruction.op == Op::add;
    if (!isSum && instruction.op != Op::subtract) return std::nullopt;
    for (std::size_t i = 0; i < (isSum ? 2u : 1u); ++i) {
      const VariableId number = instruction.arguments[i];
      const auto* floats =
          isConstant(number) ? std::get_if<std::vector<float>>(&program_.variables[number].value) : nullptr;
      if (!floats || type.isArray()) continue;
      const double other = magnitude(instruction.arguments[1 - i]);
      if (!std::all_of(floats->begin(), floats->end(), [&](float c) { return absorbs(c, other); })) continue;
      const std::size_t count = leafCount(type);
      return constant({type, floats->size() == count ? *floats : std::vector<float>(count, floats->front())});
    }
    return std::nullopt;
  }

  /// x * 1, x / 1, x - 0: identities that keep every bit. (x + 0 does not: -0 + 0 is 0; nor does x * 0.)
  std::optional<VariableId> identity(const Instruction& instruction, const Type& type) {
    if (instruction.arguments.size() != 2) return std::nullopt;
    const VariableId left = instruction.arguments[0], right = instruction.arguments[1];
    const auto passes = [&](VariableId id) -> std::optional<VariableId> {
      return program_.variables[id].type == type ? std::optional(id) : std::nullopt;
    };
    const auto holds = [&](VariableId id, float number, std::int32_t integer) {
      if (!isConstant(id) || program_.variables[id].type.base == BaseType::matrix) return false;
      const ConstantValue& value = program_.variables[id].value;
      if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&value))
        return ints->size() == 1 && (*ints)[0] == integer;
      const auto* floats = std::get_if<std::vector<float>>(&value);
      return floats && std::all_of(floats->begin(), floats->end(), [&](float f) {
               return std::bit_cast<std::uint32_t>(f) == std::bit_cast<std::uint32_t>(number);
             });
    };
    if (type.base == BaseType::matrix) return std::nullopt;
    if (const auto sum = absorbed(instruction, type)) return sum;
    switch (instruction.op) {
      case Op::multiply:
        if (holds(right, 1.0f, 1)) return passes(left);
        return holds(left, 1.0f, 1) ? passes(right) : std::nullopt;
      case Op::divide:
        return holds(right, 1.0f, 1) ? passes(left) : std::nullopt;
      case Op::subtract:
        return holds(right, 0.0f, 0) ? passes(left) : std::nullopt;
      case Op::add:
        if (holds(right, -0.0f, 0)) return passes(left);
        return holds(left, -0.0f, 0) ? passes(right) : std::nullopt;
      default:
        return std::nullopt;
    }
  }

  Program program_;
  std::vector<std::uint32_t> writes_;                               ///< By variable: instructions that write it.
  std::unordered_map<std::string, VariableId> constants_;           ///< By bitsKey.
  std::map<std::pair<VariableId, std::string>, VariableId> named_;  ///< Copies of constants for their name's sake.
  std::vector<VariableId> temporaries_;                             ///< By variable: what stands for a temporary.
  std::unordered_map<VariableId, double> magnitudes_;               ///< Of temporaries: see magnitude.h.
  std::unordered_map<VariableId, Instruction> elements_;            ///< By temporary: how it was read from an array.
  Known known_;
  Code start_;
};

}  // namespace

Program specialise(const Program& program, const ParameterValues& values) {
  Program special = Specialiser(program, values).run();
  return resolveConstancy(special) ? Specialiser(special, {}).run() : special;
}

}  // namespace aerosol::lang

#include "core/lang/output_facts.h"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace aerosol::lang {

namespace {

/// Value numbering on structured code (Cocke and Schwartz 1970): values get one number where they are computed by the
/// same operation from values with the same numbers. A triple is grey where it is made of one number; a component of a
/// grey triple has the same number whichever it is. Whether a variable that is written several times may have a colour
/// is one fact for all of the program, which begins as `no` and is repeated until nothing contradicts it.
class GreyAnalysis {
 public:
  explicit GreyAnalysis(const Program& program)
      : program_(program), numbers_(program.variables.size()), mayBeColoured_(program.variables.size(), false) {
    for (VariableId id = 0; id < program.variables.size(); ++id) {
      if (isTriple(id) && program.variables[id].storage != Storage::local &&
          program.variables[id].storage != Storage::temporary) {
        mayBeColoured_[id] = !isGreyConstant(program.variables[id]);
      }
    }
    do {
      changed_ = false;
      known_.clear();
      for (VariableId id = 0; id < numbers_.size(); ++id) numbers_[id] = initialNumber(id);
      walk(program.body);
    } while (changed_);
  }

  bool isGrey(VariableId id) const { return !mayBeColoured_[id]; }

 private:
  using Number = std::uint32_t;
  /// An operation, its detail (a function, or bits) and the numbers of its arguments.
  using Key = std::vector<Number>;
  static constexpr Number constantKey = 0x10000, greyComponentKey = 0x10001;

  bool isTriple(VariableId id) const { return program_.variables[id].type.isTriple(); }

  /// The first function with that name in the run-time library.
  Number functionNumber(std::uint32_t function) const {
    const std::string& symbol = program_.functions[function].symbol;
    const auto first =
        std::ranges::find_if(program_.functions, [&](const FunctionUse& use) { return use.symbol == symbol; });
    return static_cast<Number>(first - program_.functions.begin());
  }

  static bool isGreyConstant(const Variable& variable) {
    const auto* floats = std::get_if<std::vector<float>>(&variable.value);
    if (variable.storage != Storage::constant || !floats) return false;
    return std::ranges::all_of(*floats, [&](float f) {
      return std::bit_cast<std::uint32_t>(f) == std::bit_cast<std::uint32_t>(floats->front());
    });
  }

  Number fresh() { return next_++; }
  Number numberOf(Key key) {
    const auto [known, isNew] = known_.try_emplace(std::move(key), next_);
    if (isNew) ++next_;
    return known->second;
  }
  Number initialNumber(VariableId id) {
    const Variable& variable = program_.variables[id];
    const auto* floats = std::get_if<std::vector<float>>(&variable.value);
    if (variable.storage != Storage::constant || !floats) return fresh();
    Key key{constantKey};
    for (const float f : *floats) key.push_back(std::bit_cast<std::uint32_t>(f));
    return numberOf(std::move(key));
  }

  void walk(const Code& code) {
    for (const Instruction& instruction : code) {
      if (instruction.bodies.empty()) {
        step(instruction);
        continue;
      }
      // What the bodies write is something else from round to round, and behind them.
      const auto forget = [&] {
        for (const Code& body : instruction.bodies) {
          forEachInstruction(body, [&](const Instruction& inner) {
            forEachWritten(program_, inner, [&](VariableId id) { numbers_[id] = fresh(); });
          });
        }
      };
      for (const Code& body : instruction.bodies) {
        forget();
        walk(body);
      }
      forget();
    }
  }

  void step(const Instruction& instruction) {
    if (instruction.op == Op::call) {
      const FunctionUse& function = program_.functions[instruction.function];
      const bool isRepeatable = function.pure && !function.host && function.outputs == 0 && !function.native;
      forEachWritten(program_, instruction, [&](VariableId id) { write(id, fresh(), true); });
      if (isRepeatable && instruction.result != noVariable) numbers_[instruction.result] = operationNumber(instruction);
      return;
    }
    if (instruction.result == noVariable) return;
    if (updatesResult(instruction.op) || instruction.op == Op::message) {
      write(instruction.result, fresh(), true);
    } else if (instruction.op == Op::assign) {
      write(instruction.result, numbers_[instruction.arguments[0]], hasColour(instruction));
    } else {
      write(instruction.result, operationNumber(instruction), hasColour(instruction));
    }
  }

  Number operationNumber(const Instruction& instruction) {
    const std::vector<VariableId>& arguments = instruction.arguments;
    if (instruction.op == Op::component && isGrey(arguments[0]))
      return numberOf({greyComponentKey, numbers_[arguments[0]]});
    Key key{static_cast<Number>(instruction.op), instruction.op == Op::call ? functionNumber(instruction.function) : 0};
    for (const VariableId id : arguments) key.push_back(numbers_[id]);
    return numberOf(std::move(key));
  }

  bool hasColour(const Instruction& instruction) const {
    const std::vector<VariableId>& arguments = instruction.arguments;
    switch (instruction.op) {
      case Op::toTriple:
        return false;
      case Op::makeTriple:
        return !std::ranges::all_of(arguments, [&](VariableId id) { return numbers_[id] == numbers_[arguments[0]]; });
      case Op::assign:
      case Op::negate:
      case Op::add:
      case Op::subtract:
      case Op::multiply:
      case Op::divide:
      case Op::modulo:
      case Op::select:
        return std::ranges::any_of(arguments, [&](VariableId id) { return isTriple(id) && !isGrey(id); });
      default:
        return true;
    }
  }

  void write(VariableId id, Number number, bool hasColour) {
    numbers_[id] = number;
    if (!hasColour || !isTriple(id) || mayBeColoured_[id]) return;
    mayBeColoured_[id] = true;
    changed_ = true;
  }

  const Program& program_;
  std::vector<Number> numbers_;
  std::vector<bool> mayBeColoured_;
  std::map<Key, Number> known_;
  Number next_ = 0;
  bool changed_ = false;
};

/// Variables that are 0 whenever they are read: what is multiplied by 0, and sums of such. (Where the other factor is
/// not finite the product is no number, which is taken as 0 by those who ask.) As above, what is written several times
/// is 0 until something contradicts it.
class ZeroAnalysis {
 public:
  explicit ZeroAnalysis(const Program& program) : program_(program), mayDiffer_(program.variables.size(), false) {
    for (VariableId id = 0; id < program.variables.size(); ++id) {
      const Storage storage = program.variables[id].storage;
      const bool isWritten = storage == Storage::local || storage == Storage::temporary;
      mayDiffer_[id] = !isWritten && !isZeroConstant(program.variables[id]);
    }
    do {
      changed_ = false;
      forEachInstruction(program.body, [&](const Instruction& instruction) { step(instruction); });
    } while (changed_);
  }

  bool isZero(VariableId id) const { return !mayDiffer_[id]; }

 private:
  static bool isZeroConstant(const Variable& variable) {
    const auto* floats = std::get_if<std::vector<float>>(&variable.value);
    return variable.storage == Storage::constant && floats &&
           std::ranges::all_of(*floats, [](float f) { return f == 0; });
  }

  void step(const Instruction& instruction) {
    if (instruction.op == Op::call || instruction.result == noVariable || !isZeroResult(instruction))
      forEachWritten(program_, instruction, [&](VariableId id) {
        changed_ = changed_ || !mayDiffer_[id];
        mayDiffer_[id] = true;
      });
  }

  bool isZeroResult(const Instruction& instruction) const {
    const std::vector<VariableId>& arguments = instruction.arguments;
    switch (instruction.op) {
      case Op::multiply:
        return isZero(arguments[0]) || isZero(arguments[1]);
      case Op::divide:
        return isZero(arguments[0]);
      case Op::select:
        return isZero(arguments[1]) && isZero(arguments[2]);
      case Op::component:
        return isZero(arguments[0]);
      case Op::assign:
      case Op::toTriple:
      case Op::makeTriple:
      case Op::negate:
      case Op::add:
      case Op::subtract:
        return std::ranges::all_of(arguments, [&](VariableId id) { return isZero(id); });
      default:
        return false;
    }
  }

  const Program& program_;
  std::vector<bool> mayDiffer_;
  bool changed_ = false;
};

/// What computes the outputs of a kind, for the given parameters; nothing where there are none.
std::optional<Program> programOf(const Program& program, const ParameterValues& values, OutputKind output) {
  std::vector<Output> wanted;
  for (const Output& each : program.outputs) {
    if (each.kind == output) wanted.push_back(each);
  }
  if (wanted.empty()) return {};
  return specialise(slice(program, wanted, Messages::drop), values);
}

}  // namespace

bool isGrey(const Program& program, const ParameterValues& values, OutputKind output) {
  const std::optional<Program> special = programOf(program, values, output);
  if (!special) return true;
  const GreyAnalysis analysis(*special);
  return std::ranges::all_of(special->outputs, [&](const Output& each) { return analysis.isGrey(each.variable); });
}

bool isZero(const Program& program, const ParameterValues& values, OutputKind output) {
  const std::optional<Program> special = programOf(program, values, output);
  if (!special) return true;
  const ZeroAnalysis analysis(*special);
  return std::ranges::all_of(special->outputs, [&](const Output& each) { return analysis.isZero(each.variable); });
}

}  // namespace aerosol::lang

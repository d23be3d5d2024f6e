#include "core/lang/derivatives.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "core/lang/analysis.h"
#include "core/lang/builtins.h"
#include "core/lang/derivative_activity.h"
#include "core/lang/derivative_builder.h"
#include "core/lang/derivative_rules.h"
#include "core/lang/uniformity.h"
#include "core/lang/user_data.h"

namespace aerosol::lang {

namespace {

constexpr std::array<const char*, axisCount> axisSuffixes = {".dx", ".dy", ".dz"};

/// One walk over the code. What it computes stays, followed by the derivatives of what was written. All of them are
/// computed before the first is stored, from values as they were before the instruction, so that a variable may be
/// computed from itself.
class Differentiator {
 public:
  explicit Differentiator(Program& program) : program_(program), activity_(program), builder_(program) {
    for (auto& derivatives : derivatives_) derivatives.assign(program.variables.size(), zero);
  }

  void run() { program_.body = walk(program_.body); }

 private:
  static constexpr VariableId zero = DerivativeBuilder::zero;

  struct Change {
    VariableId target = noVariable;
    std::size_t axis = 0;
    VariableId derivative = zero;
  };
  /// An instruction, with its arguments as they were before it ran.
  struct Step {
    const Instruction& instruction;
    std::vector<VariableId> arguments;
    std::vector<VariableId> gradient;  ///< Of a noise: partial derivatives (FunctionRule::gradient).
  };

  Code walk(const Code& code) {
    Code out;
    for (const Instruction& instruction : code) {
      if (!isControl(instruction.op)) {
        differentiate(instruction, out);
        continue;
      }
      Instruction copy = instruction;
      for (std::size_t i = 0; i < copy.bodies.size(); ++i) copy.bodies[i] = walk(instruction.bodies[i]);
      out.push_back(std::move(copy));
    }
    return out;
  }

  void differentiate(const Instruction& instruction, Code& out) {
    builder_.begin(out, instruction.location);
    if (const auto query = queryOf(program_, instruction)) {
      const VariableId value = answer(*query, instruction.arguments[0]);
      set(instruction.result, value);
      store(instruction, changesOf({instruction, instruction.arguments, {}}));
      return;
    }
    bool isActive = false;
    forEachWritten(program_, instruction, [&](VariableId id) { isActive = isActive || activity_.isActive(id); });
    if (!isActive) {
      out.push_back(instruction);
      return;
    }
    Step step{instruction, instruction.arguments, {}};
    keepOverwritten(step);
    const FunctionRule* const rule = ruleOf(instruction);
    if (rule && !rule->gradient.empty() && varies(instruction)) {
      appendNoise(step, *rule);
    } else {
      out.push_back(instruction);
    }
    store(instruction, changesOf(step));
  }

  /// Arguments that the instruction itself writes are copied before it.
  void keepOverwritten(Step& step) {
    const Instruction& instruction = step.instruction;
    for (std::size_t i = 0; i < step.arguments.size(); ++i) {
      const VariableId argument = step.arguments[i];
      if (writesArgument(program_, instruction, i) || program_.variables[argument].type.isArray()) continue;
      bool isOverwritten = false;
      forEachWritten(program_, instruction, [&](VariableId id) { isOverwritten = isOverwritten || id == argument; });
      if (!isOverwritten) continue;
      step.arguments[i] = builder_.temporary(program_.variables[argument].type);
      Instruction& copy = builder_.append(Op::assign);
      copy.result = step.arguments[i];
      copy.arguments = {argument};
    }
  }

  const FunctionRule* ruleOf(const Instruction& instruction) const {
    return instruction.op == Op::call ? findFunctionRule(program_.functions[instruction.function]) : nullptr;
  }

  /// Whether any argument has a derivative.
  bool varies(const Instruction& instruction) const {
    return std::any_of(instruction.arguments.begin(), instruction.arguments.end(),
                       [&](VariableId id) { return activity_.isActive(id); });
  }

  /// The variable that holds a variable's derivative; `zero` where it has none, or none is wanted.
  VariableId derivative(VariableId id, std::size_t axis) {
    if (!activity_.isActive(id, axis)) return zero;
    if (derivatives_[axis][id] != zero) return derivatives_[axis][id];
    Variable variable = program_.variables[id];
    variable.name += axisSuffixes[axis];
    if (variable.storage == Storage::parameter) variable.storage = Storage::local;
    if (variable.storage == Storage::global) {
      const auto global = derivativeGlobal(variable.global, axis);
      variable.storage = global ? Storage::global : Storage::local;
      if (global) {
        variable.global = *global;
        variable.name = "d" + program_.variables[id].name + "d" + axisSuffixes[axis][2];
      }
    }
    const std::uint32_t location = variable.location;
    const VariableId made = builder_.addVariable(std::move(variable));
    program_.variables[made].location = location;
    return derivatives_[axis][id] = made;
  }

  void set(VariableId target, VariableId value) {
    const Type type = program_.variables[target].type;
    const VariableId given = builder_.as(type, value);
    Instruction& assign = builder_.append(Op::assign);
    assign.result = target;
    assign.arguments = {given};
  }

  std::vector<Change> changesOf(const Step& step) {
    std::vector<Change> changes;
    const Instruction& instruction = step.instruction;
    const auto add = [&](VariableId target, std::optional<std::size_t> output) {
      for (std::size_t axis = 0; axis < axisCount; ++axis)
        if (activity_.isActive(target, axis)) changes.push_back({target, axis, change(step, target, output, axis)});
    };
    if (instruction.result != noVariable) add(instruction.result, std::nullopt);
    for (std::size_t i = 0; i < instruction.arguments.size(); ++i)
      if (writesArgument(program_, instruction, i)) add(instruction.arguments[i], i);
    return changes;
  }

  void store(const Instruction& instruction, const std::vector<Change>& changes) {
    for (const Change& change : changes) {
      const VariableId target = derivative(change.target, change.axis);
      if (!updatesResult(instruction.op)) {
        set(target, change.derivative);
        continue;
      }
      const Type type = program_.variables[target].type;
      const Type part = instruction.op == Op::setElement ? type.element() : types::floating;
      const VariableId value = builder_.as(part, change.derivative);
      Instruction& update = builder_.append(instruction.op);
      update.result = target;
      update.arguments = instruction.arguments;
      update.arguments.back() = value;
    }
  }

  VariableId answer(DerivativeQuery query, VariableId x) {
    const VariableId dx = derivative(x, 0), dy = derivative(x, 1);
    switch (query) {
      case DerivativeQuery::dx:
        return dx;
      case DerivativeQuery::dy:
        return dy;
      case DerivativeQuery::dz:
        return derivative(x, 2);
      case DerivativeQuery::filterwidth:
        return filterwidth(x, dx, dy);
      case DerivativeQuery::area:
        if (dx == zero || dy == zero) return zero;
        return builder_.call("length", types::floating, {builder_.call("cross", types::vector, {dx, dy})});
      case DerivativeQuery::calculatenormal:
        return normal(dx, dy);
    }
    return zero;
  }

  VariableId filterwidth(VariableId x, VariableId dx, VariableId dy) {
    if (dx == zero && dy == zero) return zero;
    const auto width = [&](VariableId a, VariableId b) {
      if (a == zero || b == zero) return builder_.call("abs", a == zero ? b : a);
      return builder_.call("hypot", types::floating, {a, b});
    };
    if (!program_.variables[x].type.isTriple()) return width(dx, dy);
    std::array<VariableId, 3> widths{};
    for (int i = 0; i < 3; ++i)
      widths[static_cast<std::size_t>(i)] = width(builder_.component(dx, i), builder_.component(dy, i));
    return builder_.triple(widths[0], widths[1], widths[2]);
  }

  VariableId normal(VariableId dx, VariableId dy) {
    if (dx == zero || dy == zero) return zero;
    Variable variable;
    variable.name = "flipHandedness";
    variable.type = types::floating;
    variable.storage = Storage::global;
    variable.global = Global::flipHandedness;
    if (flip_ == noVariable) flip_ = builder_.addVariable(std::move(variable));
    const VariableId flips = builder_.compare(Op::notEqual, flip_, builder_.number(0));
    return builder_.call("cross", types::vector, {builder_.select(flips, dy, dx), builder_.select(flips, dx, dy)});
  }

  /// The change along one axis of what the instruction has written: its result, or an argument.
  VariableId change(const Step& step, VariableId target, std::optional<std::size_t> output, std::size_t axis) {
    const Instruction& instruction = step.instruction;
    std::vector<VariableId> dx;
    bool isFlat = true;
    for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
      dx.push_back(writesArgument(program_, instruction, i) ? zero : derivative(instruction.arguments[i], axis));
      isFlat = isFlat && dx.back() == zero;
    }
    if (instruction.op == Op::call) return changeOfCall(step, target, output, axis, dx, isFlat);
    return isFlat ? zero : changeOfOperation(step, target, dx);
  }

  VariableId changeOfOperation(const Step& step, VariableId y, std::span<const VariableId> dx) {
    DerivativeBuilder& b = builder_;
    const std::vector<VariableId>& x = step.arguments;
    const Op op = step.instruction.op;
    const Type type = program_.variables[y].type;
    switch (op) {
      case Op::assign:
      case Op::toTriple:
      case Op::toMatrix:
        return dx[0];
      case Op::makeTriple:
        return b.triple(dx[0], dx[1], dx[2]);
      case Op::makeMatrix: {
        std::vector<VariableId> elements;
        for (const VariableId element : dx) elements.push_back(b.as(types::floating, element));
        return b.emit(op, type, std::move(elements));
      }
      case Op::component:
      case Op::matrixElement:
      case Op::element: {
        if (dx[0] == zero) return zero;
        std::vector<VariableId> arguments = x;
        arguments[0] = dx[0];
        return b.emit(op, type, std::move(arguments));
      }
      case Op::setComponent:
      case Op::setMatrixElement:
      case Op::setElement:
        return dx.back();
      case Op::negate:
        return b.negate(dx[0]);
      case Op::add:
        return b.add(dx[0], dx[1]);
      case Op::subtract:
        return b.subtract(dx[0], dx[1]);
      case Op::multiply:
        return b.add(b.multiply(dx[0], x[1]), b.multiply(x[0], dx[1]));
      case Op::divide:
        if (dx[1] == zero) return b.divide(dx[0], x[1]);
        return b.divide(b.subtract(b.as(type, dx[0]), b.multiply(y, dx[1])), x[1]);
      case Op::modulo:
        return changeOfRemainder(type, x, dx);
      case Op::select:
        return dx[1] == zero && dx[2] == zero ? zero : b.select(x[0], dx[1], dx[2]);
      default:
        return zero;
    }
  }

  VariableId changeOfRemainder(const Type& type, std::span<const VariableId> x, std::span<const VariableId> dx) {
    const FunctionRule& rule = *findFunctionRule("fmod_f_ff");
    if (!type.isTriple()) return rule.rule(builder_, {"fmod_f_ff", x, dx, noVariable});
    const auto part = [&](VariableId id, int i) {
      return id == zero || !program_.variables[id].type.isTriple() ? id : builder_.component(id, i);
    };
    std::array<VariableId, 3> parts{};
    for (int i = 0; i < 3; ++i) {
      const std::array<VariableId, 2> xs = {part(x[0], i), part(x[1], i)}, dxs = {part(dx[0], i), part(dx[1], i)};
      parts[static_cast<std::size_t>(i)] = rule.rule(builder_, {"fmod_f_ff", xs, dxs, noVariable});
    }
    return builder_.triple(parts[0], parts[1], parts[2]);
  }

  VariableId changeOfCall(const Step& step, VariableId y, std::optional<std::size_t> output, std::size_t axis,
                          std::span<const VariableId> dx, bool isFlat) {
    const Instruction& instruction = step.instruction;
    const FunctionUse function = program_.functions[instruction.function];
    if (output && function.symbol == "getmatrix_i_ssm") {
      // A matrix between unknown spaces stays what it was.
      return builder_.select(instruction.result, zero, derivative(y, axis));
    }
    if (output && givesUserData(program_, instruction)) {
      // What is not found leaves the variable as it was.
      const VariableId found = changeOfUserData(instruction, axis), before = derivative(y, axis);
      return program_.variables[y].type.isArray() ? chooseArray(instruction.result, found, before)
                                                  : builder_.select(instruction.result, found, before);
    }
    if (isFlat) return zero;
    const FunctionRule* const rule = findFunctionRule(function);
    const DifferentiatedCall call{function.symbol, step.arguments, dx, y};
    if (!rule) return function.pure && !output ? difference(step, y, dx) : zero;
    if (output) return rule->outputRule ? rule->outputRule(builder_, call, *output) : zero;
    if (!rule->gradient.empty()) return changeOfNoise(step, dx);
    return rule->rule ? rule->rule(builder_, call) : zero;
  }

  VariableId localOf(const Type& type) {
    Variable variable;
    variable.type = type;
    variable.storage = Storage::local;
    return builder_.addVariable(std::move(variable));
  }

  /// One of two arrays, or as much of it as there is; `no` may be `zero`.
  VariableId chooseArray(VariableId condition, VariableId yes, VariableId no) {
    const Type type = program_.variables[yes].type;
    const VariableId chosen = localOf(type), other = builder_.as(type, no);
    Instruction& branch = builder_.append(Op::branch);
    branch.arguments = {condition};
    for (const VariableId value : {yes, other}) {
      Instruction assign;
      assign.op = Op::assign;
      assign.location = branch.location;
      assign.result = chosen;
      assign.arguments = {value};
      branch.bodies.push_back({std::move(assign)});
    }
    return chosen;
  }

  /// int userdatachange(string name, int axis, output any change)
  VariableId changeOfUserData(const Instruction& instruction, std::size_t axis) {
    const std::uint32_t function = builder_.hostFunction("userdatachange", 1u << 2, dependsOnPoint);
    const VariableId number = builder_.integer(static_cast<std::int32_t>(axis));
    const VariableId change = localOf(program_.variables[instruction.arguments[1]].type);
    const VariableId found = builder_.temporary(types::integer);
    Instruction& call = builder_.append(Op::call);
    call.function = function;
    call.result = found;
    call.arguments = {instruction.arguments[0], number, change};
    return change;
  }

  /// Forward difference over the footprint itself, for functions that are not known.
  VariableId difference(const Step& step, VariableId y, std::span<const VariableId> dx) {
    std::vector<VariableId> moved;
    for (std::size_t i = 0; i < dx.size(); ++i) {
      const bool isArray = program_.variables[step.arguments[i]].type.isArray();
      moved.push_back(isArray ? step.arguments[i] : builder_.add(step.arguments[i], dx[i]));
    }
    const VariableId there = builder_.temporary(program_.variables[y].type);
    Instruction& call = builder_.append(Op::call);
    call.function = step.instruction.function;
    call.result = there;
    call.arguments = std::move(moved);
    return builder_.subtract(there, y);
  }

  /// The noise with its partial derivatives in place of the noise alone.
  void appendNoise(Step& step, const FunctionRule& rule) {
    const Instruction& instruction = step.instruction;
    const Type result = program_.variables[instruction.result].type;
    const std::size_t coordinates = instruction.arguments.size() / (rule.periodic ? 2 : 1);
    for (std::size_t i = 0; i < coordinates; ++i) {
      const bool isTriple = program_.variables[instruction.arguments[i]].type.isTriple();
      if (!isTriple || !result.isTriple()) {
        step.gradient.push_back(builder_.temporary(isTriple ? types::vector : result));
      } else {
        for (int k = 0; k < 3; ++k) step.gradient.push_back(builder_.temporary(result));
      }
    }
    std::vector<VariableId> arguments = instruction.arguments;
    std::uint32_t outputs = 0;
    for (const VariableId partial : step.gradient) {
      outputs |= 1u << arguments.size();
      arguments.push_back(partial);
    }
    std::vector<Type> types;
    for (const VariableId argument : arguments) types.push_back(program_.variables[argument].type);
    const std::uint32_t function = builder_.function(symbolOf(rule.gradient, result, types), outputs);
    Instruction& call = builder_.append(Op::call);
    call.function = function;
    call.result = instruction.result;
    call.arguments = std::move(arguments);
  }

  VariableId changeOfNoise(const Step& step, std::span<const VariableId> dx) {
    DerivativeBuilder& b = builder_;
    VariableId sum = zero;
    std::size_t partial = 0;
    for (std::size_t i = 0; i < dx.size() && partial < step.gradient.size(); ++i) {
      const VariableId gradient = step.gradient[partial];
      const bool isTriple = program_.variables[step.arguments[i]].type.isTriple();
      const bool givesTriple = program_.variables[step.instruction.result].type.isTriple();
      if (!isTriple) {
        sum = b.add(sum, b.multiply(gradient, dx[i]));
        partial += 1;
      } else if (!givesTriple) {
        if (dx[i] != zero) sum = b.add(sum, b.call("dot", types::floating, {gradient, dx[i]}));
        partial += 1;
      } else {
        for (int k = 0; k < 3; ++k)
          sum = b.add(sum, b.multiply(step.gradient[partial + static_cast<std::size_t>(k)], b.component(dx[i], k)));
        partial += 3;
      }
    }
    return sum;
  }

  Program& program_;
  const DerivativeActivity activity_;
  DerivativeBuilder builder_;
  std::array<std::vector<VariableId>, axisCount> derivatives_;  ///< By variable: where its derivative is.
  VariableId flip_ = noVariable;
};

}  // namespace

bool readsDerivatives(const Program& program) {
  return std::any_of(program.functions.begin(), program.functions.end(),
                     [](const FunctionUse& function) { return queryOf(function).has_value(); });
}

Program expandDerivatives(Program program) {
  Differentiator(program).run();
  return program;
}

bool hasDerivativeRule(std::string_view symbol) { return findFunctionRule(symbol) != nullptr; }

}  // namespace aerosol::lang

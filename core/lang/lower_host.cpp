// Calls of the host's functions.
#include <algorithm>

#include "core/lang/lowerer.h"
#include "core/lang/pure_functions.h"
#include "core/lang/regex.h"
#include "core/lang/user_data.h"

namespace aerosol::lang {

VariableId Lowerer::callHost(const std::string& function, const Type& result, std::vector<VariableId> arguments,
                             HostUse use) {
  if (use.outputs == 0 && use.traits == 0 && use.pure && use.folds) {
    if (const auto known = foldHostCall(function, result, arguments)) return constant(*known);
  }
  if (!countWork(position_)) return constant(zeroConstant(result));
  const std::string key = "host " + function + " " + std::to_string(use.outputs);
  const auto [known, isNew] = functions_.emplace(key, static_cast<std::uint32_t>(program_.functions.size()));
  if (isNew) program_.functions.push_back({function, use.pure, use.outputs, true, use.traits});
  const VariableId target = result == types::none ? noVariable : temporary(result);
  Instruction& instruction = append(Op::call);
  instruction.function = known->second;
  instruction.result = target;
  instruction.arguments = std::move(arguments);
  return target;
}

std::optional<Constant> Lowerer::foldHostCall(const std::string& function, const Type& result,
                                              std::span<const VariableId> arguments) const {
  std::vector<Constant> values;
  for (const VariableId argument : arguments) {
    auto value = constantOf(argument);
    if (!value) return std::nullopt;
    values.push_back(std::move(*value));
  }
  return evaluateCall(function, result, values, 0);
}

/// Arguments in their order; what is written goes through a variable of its own where it is only a part of one.
Value Lowerer::lowerHostCall(const Expression& expression, const Call& called) {
  const BuiltinOverload& overload = *called.builtin;
  const auto& arguments = called.arguments;
  if (arguments.size() > 1 && arguments.back()->type == types::closure) {
    if (called.name == "setmessage") return lowerSetClosureMessage(expression, called);
    if (called.name == "getmessage") return lowerGetClosureMessage(expression, called);
  }
  std::vector<VariableId> ids;
  std::vector<std::pair<Place, VariableId>> copiesBack;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool isFixed = i < overload.parameters.size();
    if ((overload.outputs >> std::min<std::size_t>(i, 31) & 1u) != 0 && isFixed) {
      const Place target = place(*arguments[i]);
      VariableId variable = target.leaves[0];
      if (!target.isWhole()) {
        variable = local(target.type, "");
        assign(variable, load(target).single());
        copiesBack.emplace_back(target, variable);
      }
      ids.push_back(variable);
      continue;
    }
    const bool converts = isFixed && !(overload.parameters[i] == types::none);
    Value value = converts ? lowerTo(*arguments[i], overload.parameters[i]) : lower(*arguments[i]);
    value = protect(std::move(value), std::span(arguments).subspan(i + 1));
    if (value.leaves.size() != 1 || value.type.closure || value.type.base == BaseType::structure) {
      error(arguments[i]->position, "'" + called.name + "' takes no value of type " + toString(arguments[i]->type));
      return overload.result == types::none ? Value{types::none, {}} : zeroValue(overload.result);
    }
    ids.push_back(value.single());
  }
  if (std::string_view(overload.row->name).starts_with("regex_")) {
    const auto known = constantOf(ids.back());
    if (known && !Regex::compile(known->asString()))
      error(arguments.back()->position, "malformed or too long regular expression");
  }
  position_ = expression.position;
  const BuiltinRow& row = *overload.row;
  const VariableId result =
      callHost(row.symbol, overload.result, std::move(ids), {overload.outputs, row.traits, row.pure});
  for (const auto& [target, variable] : copiesBack) store(target, {target.type, {variable}});
  if (overload.result == types::none) return {types::none, {}};
  return {overload.result, {result}};
}

/// The shader's own name is known here: in a group each layer has its own.
Value Lowerer::lowerGetAttribute(const Expression& expression, const Call& called) {
  const auto& arguments = called.arguments;
  if (arguments.size() == 2 && arguments[1]->type == types::string) {
    const auto* name = std::get_if<StringLiteral>(&arguments[0]->node);
    if (name && name->value == "shader:shadername") {
      store(place(*arguments[1]), {types::string, {constantString(program_.name)}});
      return {types::integer, {constantInt(1)}};
    }
  }
  return lowerHostCall(expression, called);
}

/// A call that stays until the parameters are known (see resolveConstancy).
Value Lowerer::lowerIsConstant(const Expression& expression, const Call& called) {
  const Value value = lower(*called.arguments[0]);
  position_ = expression.position;
  if (isConstantValue(value)) return {types::integer, {constantInt(1)}};
  return {types::integer, {callHost("isconstant", types::integer, {value.single()}, {.folds = false})}};
}

/// Calls are counted as the shader runs, so that loops get new numbers and calls can be left out and moved as any
/// others that depend on their arguments alone. The bounds are for ranges.
Value Lowerer::lowerRandom(const Expression& expression, const Call& called) {
  position_ = expression.position;
  const Type& type = called.builtin->result;
  if (randomCalls_ == noVariable) randomCalls_ = local(types::integer, "random numbers");
  const VariableId number = temporary(types::integer);
  Instruction& copy = append(Op::assign);
  copy.result = number;
  copy.arguments = {randomCalls_};
  assign(randomCalls_, emit(Op::add, types::integer, {number, constantInt(1)}));
  const VariableId drawn =
      callHost("random", type, {number, constantString(program_.name)}, {.traits = dependsOnPoint, .folds = false});
  return componentwise("min", type,
                       {componentwise("max", type, {{type, {drawn}}, zeroValue(type)}),
                        convert({types::floating, {constantFloat(1)}}, type)});
}

void Lowerer::bindUserData(const Parameter& parameter) {
  if (!readsUserData(parameter) || parameter.type.base == BaseType::string) return;
  const HostUse use{.outputs = 1u << 1, .traits = dependsOnPoint};
  callHost("userdata", types::integer, {constantString(parameter.name), parameter.variable}, use);
}

}  // namespace aerosol::lang

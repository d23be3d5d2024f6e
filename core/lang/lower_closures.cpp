#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/lang/lowerer.h"

namespace aerosol::lang {

Value Lowerer::lowerClosure(const Expression& expression, const Call& called) {
  const ClosureRow& row = *called.closure;
  if (row.name == std::string_view(layerClosure)) return lowerLayer(expression, called);
  const std::vector<ClosureParameter> parameters = closureParameters(row), options = closureOptions(row);
  ClosureSite site;
  site.closure = row.name;
  site.location = locationOf(expression.position);
  std::vector<VariableId> arguments;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Value value = lowerTo(*called.arguments[i], parameters[i].type);
    arguments.push_back(protect(value, std::span(called.arguments).subspan(i + 1)).single());
    site.parameterNames.push_back(parameters[i].name);
    site.parameterTypes.push_back(parameters[i].type);
  }
  std::vector<VariableId> optionValues;
  for (const ClosureParameter& option : options) {
    optionValues.push_back(constant(zeroConstant(option.type)));
    site.parameterNames.push_back(option.name);
    site.parameterTypes.push_back(option.type);
  }
  for (std::size_t i = parameters.size(); i + 1 < called.arguments.size(); i += 2) {
    const auto& key = std::get<StringLiteral>(called.arguments[i]->node);
    const Expression& given = *called.arguments[i + 1];
    const auto option =
        std::find_if(options.begin(), options.end(), [&](const auto& known) { return known.name == key.value; });
    if (option == options.end()) {
      lower(given);
    } else {
      const Value value{option->type, {lowerSingle(given, option->type)}};
      optionValues[static_cast<std::size_t>(option - options.begin())] =
          protect(value, std::span(called.arguments).subspan(i + 2)).single();
    }
  }
  arguments.insert(arguments.end(), optionValues.begin(), optionValues.end());
  const bool hasMeaning = program_.kind == "volume" ? row.volume : program_.kind != "displacement";
  return hasMeaning ? makeClosure(std::move(site), std::move(arguments), expression.position)
                    : zeroValue(types::closure);
}

Value Lowerer::makeClosure(ClosureSite site, std::vector<VariableId> arguments, Position position) {
  if (!countWork(position)) return zeroValue(types::closure);
  position_ = position;
  const VariableId result = temporary(types::closure);
  Instruction& instruction = append(Op::closureMake);
  instruction.result = result;
  instruction.site = static_cast<std::uint32_t>(program_.closureSites.size());
  instruction.arguments = std::move(arguments);
  program_.closureSites.push_back(std::move(site));
  return {types::closure, {result}};
}

Value Lowerer::lowerLayer(const Expression& expression, const Call& called) {
  const Value top = protect(lowerTo(*called.arguments[0], types::closure), *called.arguments[1]);
  const Value base = lowerTo(*called.arguments[1], types::closure);
  position_ = expression.position;
  const Op op = program_.isVolume() ? Op::closureAdd : Op::closureLayer;
  const VariableId result = emit(op, types::closure, {top.single(), base.single()});
  if (op == Op::closureLayer && !failed_) code_->back().site = layeringCount_++;
  return {types::closure, {result}};
}

/// A closure that the source declares itself, as a function without a body marked as built in.
Value Lowerer::makeDeclaredClosure(const FunctionDeclaration& function, const std::vector<Value>& arguments,
                                   Position position) {
  ClosureSite site;
  site.closure = function.name;
  site.location = locationOf(position);
  std::vector<VariableId> values;
  for (std::size_t i = 0; i < std::min(arguments.size(), function.parameters.size()); ++i) {
    const auto& formal = *function.parameters[i];
    // Nothing here reads what only another renderer's closure has: arrays, closures and structures are left out.
    if (formal.type.isArray() || formal.type.closure || formal.type.base == BaseType::structure) continue;
    values.push_back(arguments[i].single());
    site.parameterNames.push_back(formal.name);
    site.parameterTypes.push_back(formal.type);
  }
  const bool hasMeaning = program_.kind != "volume" && program_.kind != "displacement";
  return hasMeaning ? makeClosure(std::move(site), std::move(values), position) : zeroValue(types::closure);
}

}  // namespace aerosol::lang

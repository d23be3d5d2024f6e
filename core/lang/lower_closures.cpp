#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/lang/lowerer.h"

namespace aerosol::lang {

Value Lowerer::lowerClosure(const Expression& expression, const Call& called) {
  const ClosureRow& row = *called.closure;
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
  for (const ClosureParameter& option : options) {
    VariableId value = constant(zeroConstant(option.type));
    for (std::size_t i = parameters.size(); i + 1 < called.arguments.size(); i += 2) {
      const auto& key = std::get<StringLiteral>(called.arguments[i]->node);
      if (key.value == option.name) value = lowerSingle(*called.arguments[i + 1], option.type);
    }
    arguments.push_back(value);
    site.parameterNames.push_back(option.name);
    site.parameterTypes.push_back(option.type);
  }
  if (!countWork(expression.position)) return zeroValue(types::closure);
  position_ = expression.position;
  const VariableId result = temporary(types::closure);
  Instruction& instruction = append(Op::closureMake);
  instruction.result = result;
  instruction.site = static_cast<std::uint32_t>(program_.closureSites.size());
  instruction.arguments = std::move(arguments);
  program_.closureSites.push_back(std::move(site));
  return {types::closure, {result}};
}

}  // namespace aerosol::lang

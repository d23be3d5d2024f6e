// What a shader asks about the group that it is a layer of.
#include "core/lang/lowerer.h"
#include "core/lang/root_expression.h"

namespace aerosol::lang {

Value Lowerer::lowerIsConnected(const Expression& expression, const Call& called) {
  const Value no{types::integer, {constantInt(0)}};
  if (called.arguments.size() != 1) {
    error(expression.position, "isconnected needs one parameter of the shader");
    return no;
  }
  // Nothing is connected to what is computed.
  if (!std::holds_alternative<Name>(rootOf(*called.arguments[0]).node)) {
    lower(*called.arguments[0]);
    return no;
  }
  const Place named = place(*called.arguments[0]);
  VariableId any = noVariable;
  for (const VariableId leaf : named.leaves) {
    if (program_.variables[leaf].storage != Storage::parameter) return no;
    const std::uint32_t index = program_.variables[leaf].parameter;
    if (program_.parameters[index].isConnected == noVariable) {
      const VariableId answer = local(types::integer, program_.parameters[index].name + " is connected");
      program_.parameters[index].isConnected = answer;
    }
    const VariableId one = program_.parameters[index].isConnected;
    any = any == noVariable ? one : emit(Op::bitOr, types::integer, {any, one});
  }
  return {types::integer, {any}};
}

}  // namespace aerosol::lang

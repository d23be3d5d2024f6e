#include "core/lang/user_data.h"

#include <algorithm>
#include <iterator>

#include "core/lang/code_writer.h"

namespace aerosol::lang {

bool readsUserData(const Parameter& parameter) {
  bool reads = false;
  for (const MetadataValue& entry : parameter.metadata) {
    const auto* ints = std::get_if<std::vector<std::int32_t>>(&entry.value);
    if (!ints || ints->size() != 1) continue;
    if (entry.name == "lockgeom") reads = (*ints)[0] == 0;
    if (entry.name == "interpolated") reads = (*ints)[0] != 0;
  }
  return reads;
}

Program bindUserData(Program program, std::string_view name) {
  const auto found = std::ranges::find(program.parameters, name, &Parameter::name);
  if (found == program.parameters.end() || found->variable == noVariable || readsUserData(*found) ||
      found->type.base == BaseType::string || found->type.closure)
    return program;
  Code code;
  CodeWriter writer(program);
  writer.writeTo(&code);
  writer.setLocation(program.variables[found->variable].location);
  const VariableId text = writer.constant(Constant::ofString(std::string(name)));
  program.functions.push_back({"userdata", true, 1u << 1, true, dependsOnPoint});
  const VariableId answer = writer.add(types::integer, Storage::temporary, "");
  writer.append(Op::call, answer, {text, found->variable}).function =
      static_cast<std::uint32_t>(program.functions.size() - 1);
  std::ranges::move(program.body, std::back_inserter(code));
  program.body = std::move(code);
  return program;
}

bool givesUserData(const Program& program, const Instruction& instruction) {
  if (instruction.op != Op::call || instruction.arguments.size() != 2 || instruction.result == noVariable) return false;
  const FunctionUse& function = program.functions[instruction.function];
  return function.host && (function.symbol == "userdata" || function.symbol == "getattribute");
}

}  // namespace aerosol::lang

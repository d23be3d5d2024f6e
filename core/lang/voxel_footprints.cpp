#include <string>

#include "core/base/voxel_file_name.h"
#include "core/lang/code_writer.h"
#include "core/lang/derivatives.h"
#include "core/lang/texture_options.h"

namespace aerosol::lang {

namespace {

/// Whether a variable is the constant name of a file of voxels; behind a question mark it says how to read that.
bool namesVoxels(const Variable& variable) {
  const auto* texts = std::get_if<std::vector<std::string>>(&variable.value);
  if (variable.storage != Storage::constant || !texts || texts->size() != 1) return false;
  const std::string_view name = texts->front();
  return isVoxelFileName(name.substr(0, name.find('?')));
}

}  // namespace

bool dropVoxelFootprints(Program& program) {
  static const TextureFunction& function = *findTextureFunction("texture3d");
  CodeWriter writer(program);
  bool hasChanged = false;
  const auto visit = [&](auto&& self, Code& code) -> void {
    for (Instruction& instruction : code) {
      for (Code& body : instruction.bodies) self(self, body);
      if (instruction.op != Op::call) continue;
      const FunctionUse& called = program.functions[instruction.function];
      if (!called.host || called.symbol != function.name || !namesVoxels(program.variables[instruction.arguments[0]]))
        continue;
      for (std::size_t i = 1 + function.coordinates; i < function.argumentCount(); ++i) {
        if (program.variables[instruction.arguments[i]].storage == Storage::constant) continue;
        instruction.arguments[i] = writer.zeroOf(instruction.arguments[i]);
        hasChanged = true;
      }
    }
  };
  visit(visit, program.body);
  return hasChanged;
}

}  // namespace aerosol::lang

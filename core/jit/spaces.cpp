#include "core/jit/spaces.h"

namespace aerosol::jit {

std::optional<Space> findSpace(const std::string& name) {
  if (name == "common" || name == "world") return Space::common;
  if (name == "object") return Space::object;
  if (name == "shader") return Space::shader;
  return {};
}

std::optional<std::string> constantName(const lang::Program& program, lang::VariableId variable) {
  const lang::Variable& constant = program.variables[variable];
  const auto* texts = std::get_if<std::vector<std::string>>(&constant.value);
  if (constant.storage != lang::Storage::constant || !texts || texts->size() != 1) return {};
  return texts->front();
}

bool spacesVary(const lang::Program& program, const lang::Instruction& getMatrix, bool severalInstances) {
  for (std::size_t i = 0; i < 2; ++i) {
    const std::optional<std::string> name = constantName(program, getMatrix.arguments[i]);
    const std::optional<Space> space = name ? findSpace(*name) : std::nullopt;
    // The host is asked about each point's time.
    if (!space) return true;
    if (*space != Space::common && severalInstances) return true;
  }
  return false;
}

}  // namespace aerosol::jit

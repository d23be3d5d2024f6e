// Named coordinate systems that kernels know without asking the host.
#pragma once

#include <optional>
#include <string>

#include "core/lang/program.h"

namespace aerosol::jit {

enum class Space { common, object, shader };

/// By its name in shaders; "world" is "common". Others are the host's.
std::optional<Space> findSpace(const std::string& name);

/// The name in a variable, when it is a constant.
std::optional<std::string> constantName(const lang::Program& program, lang::VariableId variable);

/// May the matrix between two spaces differ from point to point although the names do not?
bool spacesVary(const lang::Program& program, const lang::Instruction& getMatrix, bool severalInstances);

}  // namespace aerosol::jit

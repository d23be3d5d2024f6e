#include "core/base/hash.h"
#include "core/jit/compiler.h"
#include "core/lang/serialize.h"

namespace aerosol::jit {

std::string hashProgram(const lang::Program& program) { return StrongHash().add(lang::serialise(program)).hex(); }

}  // namespace aerosol::jit

// Bitcode of native plugins in kernels.
#pragma once

#include <string>

#include "core/jit/llvm.h"
#include "core/lang/native.h"
#include "core/lang/program.h"

namespace aerosol::jit {

/// What a function of a plugin is called in kernels: `name` is that in its bitcode.
std::string nativeCodeName(const lang::NativeFunction& function, const std::string& name);

/// Links the bitcode of the plugins' functions that the module calls by those names; they will be inlined. Gives what
/// went wrong, if anything.
std::string linkNatives(llvm::Module& module, const lang::Program& program);

/// What a plugin's module needs from outside that kernels do not have; empty: nothing.
std::string findMissing(const llvm::Module& module);

}  // namespace aerosol::jit

// One requested kernel as IR.
#pragma once

#include "core/base/result.h"
#include "core/jit/compiler.h"
#include "core/jit/kernel_interface.h"
#include "core/jit/llvm.h"

namespace aerosol::jit {

/// Adds the function `kernel` to the module, with declarations of the functions of the run-time library that it calls.
/// The interface is complete but for what only optimised code tells (`readInterface`).
Result<KernelInterface> buildKernel(llvm::Module& module, const KernelRequest& request, const llvm::Module& library);

/// What the finished kernel reads of its arguments.
void readInterface(const llvm::Function& kernel, KernelInterface& interface);

}  // namespace aerosol::jit

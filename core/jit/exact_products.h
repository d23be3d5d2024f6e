// Products that are exact, in sums: one instruction instead of two, with the same bits.
#pragma once

namespace llvm {
class Function;
}

namespace aerosol::jit {

/// An int made a float, times a power of two, is not rounded a second time, so that a sum of it and something else is
/// one fused multiply-add: hashes as numbers from 0 to 1, as noises add them up.
void fuseExactProducts(llvm::Function& function);

}  // namespace aerosol::jit

// What kernels may use of the processor beyond x86-64-v3, decided when a kernel is compiled and not when this library
// is.
//
// `aerosol_processor_avx512` is a weak constant, 0 by default. A compiler of kernels that targets AVX-512 (F and VL)
// sets its initialiser to 1; in both cases it makes it internal, so that the optimiser folds the branches on it away
// before code is generated. Both ways give the same bits; they differ in speed alone. (Sixteen-entry tables of
// gradients are one permutation an axis there; six-octave noise at 16 lanes runs 14% faster than with selections.)
#pragma once

#include "core/jit/runtime/wide.h"

#if defined(AEROSOL_RUNTIME_BITCODE)
extern "C" {
extern const int aerosol_processor_avx512;
}
#endif

namespace aerosol::jit::runtime {

AEROSOL_INLINE bool processorHasAvx512() {
#if defined(AEROSOL_RUNTIME_BITCODE)
  return aerosol_processor_avx512 != 0;
#else
  return true;
#endif
}

// The instruction's intrinsic must be known to be legal where it is compiled: in the bitcode for 16 lanes (compiled
// with AVX-512's attributes, which the compiler of kernels replaces), and in host code for processors with it.
#if defined(__AVX512F__) || defined(AEROSOL_RUNTIME_AVX512_ATTRIBUTES)
template <class F>
inline constexpr bool hasTablePermute = widthOf<F> == 16;

/// table[index & 15] of every lane.
AEROSOL_INLINE Wide<float, 16> permute16(Wide<float, 16> table, Wide<std::uint32_t, 16> index) {
  typedef float V __attribute__((vector_size(64)));
  typedef int N __attribute__((vector_size(64)));
  return __builtin_bit_cast(Wide<float, 16>,
                            __builtin_ia32_permvarsf512(__builtin_bit_cast(V, table), __builtin_bit_cast(N, index)));
}
#else
template <class F>
inline constexpr bool hasTablePermute = false;
template <class T, class I>
T permute16(T table, I index);
#endif

}  // namespace aerosol::jit::runtime

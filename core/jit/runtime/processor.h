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

#if defined(AEROSOL_RUNTIME_BITCODE) && defined(__x86_64__)
/// The processor's conversion, which gives the least int for what no int holds. LLVM's own has no value there.
AEROSOL_INLINE Wide<std::int32_t, 1> convertTruncating(Wide<float, 1> x) {
  typedef float V __attribute__((vector_size(16)));
  return __builtin_ia32_cvttss2si(V{x, 0, 0, 0});
}
AEROSOL_INLINE Wide<std::int32_t, 4> convertTruncating(Wide<float, 4> x) {
  typedef float V __attribute__((vector_size(16)));
  return __builtin_bit_cast(Wide<std::int32_t, 4>, __builtin_ia32_cvttps2dq(__builtin_bit_cast(V, x)));
}
AEROSOL_INLINE Wide<std::int32_t, 8> convertTruncating(Wide<float, 8> x) {
  typedef float V __attribute__((vector_size(32)));
  return __builtin_bit_cast(Wide<std::int32_t, 8>, __builtin_ia32_cvttps2dq256(__builtin_bit_cast(V, x)));
}
AEROSOL_INLINE Wide<std::int32_t, 16> convertTruncating(Wide<float, 16> x) {
#if defined(AEROSOL_RUNTIME_AVX512_ATTRIBUTES)
  if (processorHasAvx512()) {
    typedef float V __attribute__((vector_size(64)));
    typedef int N __attribute__((vector_size(64)));
    const N none = {};
    return __builtin_bit_cast(Wide<std::int32_t, 16>,
                              __builtin_ia32_cvttps2dq512_mask(__builtin_bit_cast(V, x), none, 0xffff, 4));
  }
#endif
  const Wide<std::int32_t, 8> low = convertTruncating(x.lo), high = convertTruncating(x.hi);
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
#else
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> convertTruncating(F x) {
  const IntOf<F> isInside = greaterEqual(x, F(-2147483648.0f)) & less(x, F(2147483648.0f));
  return select(isInside, toIntUnchecked(select(isInside, x, F(0.0f))), IntOf<F>(-0x7fffffff - 1));
}
#endif

/// floor(x) as an int. What no int holds, NaN too, gives the least one: lattices end there.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> floorToInt(F x) {
#if defined(AEROSOL_RUNTIME_AVX512_ATTRIBUTES)
  if constexpr (widthOf<F> == 16) {
    if (processorHasAvx512()) {
      // Rounding down is part of the conversion.
      typedef float V __attribute__((vector_size(64)));
      typedef int N __attribute__((vector_size(64)));
      const N none = {};
      return __builtin_bit_cast(IntOf<F>, __builtin_ia32_cvtps2dq512_mask(__builtin_bit_cast(V, x), none, 0xffff, 9));
    }
  }
#endif
  return convertTruncating(floor(x));
}

}  // namespace aerosol::jit::runtime

// The kernels' run-time library for one domain and width, compiled to bitcode by the build: AEROSOL_WIDTH is 1, 4, 8 or
// 16, and one of AEROSOL_DOMAIN_WIDE and AEROSOL_DOMAIN_RANGE is set.
//
// Symbols are `<prefix><base>_<result>_<arguments>`, letters f float, i int, v triple, m matrix, x no result. All
// parameters are pointers, the result first; what is written is non-const. Prefix u_ takes scalars (float, int32);
// w_ (wide domain) takes W lanes: vectors of float or int32 aligned to their size, triples as struct {x, y, z},
// matrices as struct {m[16]}, row-major; r_ (range domain) takes ranges of W lanes (range_symbols.h). Small functions
// ask to be inlined always, large ones (all of ranges) are left to the inliner. There is no state, no libm and no
// address of a global: `aerosol_processor_avx512` is a constant that the compiler of kernels folds (processor.h).

#if !defined(AEROSOL_WIDTH)
#error "AEROSOL_WIDTH must be 1, 4, 8 or 16"
#endif
#define AEROSOL_RUNTIME_BITCODE 1

// The attributes that make AVX-512 intrinsics legal here. The compiler of kernels replaces them by its target's.
#if AEROSOL_WIDTH == 16 && defined(__x86_64__)
#define AEROSOL_RUNTIME_AVX512_ATTRIBUTES 1
#pragma clang attribute push(__attribute__((target("avx512f,avx512cd,avx512bw,avx512dq,avx512vl"))), \
                             apply_to = function)
#endif

#include "core/jit/runtime/geometry.h"
#include "core/jit/runtime/math_basic.h"
#include "core/jit/runtime/math_exponential.h"
#include "core/jit/runtime/math_special.h"
#include "core/jit/runtime/math_trigonometric.h"
#include "core/jit/runtime/noise_cell.h"
#include "core/jit/runtime/noise_gradient.h"
#include "core/jit/runtime/noise_perlin.h"
#include "core/jit/runtime/noise_simplex.h"
#if defined(AEROSOL_DOMAIN_RANGE)
#include "core/jit/runtime/range_form_noise.h"
#endif

extern "C" {
extern const int aerosol_processor_avx512;
__attribute__((weak, visibility("hidden"))) const int aerosol_processor_avx512 = 0;
}

namespace aerosol::jit::runtime {

#define AEROSOL_SMALL_FUNCTION extern "C" __attribute__((always_inline)) void
#define AEROSOL_LARGE_FUNCTION extern "C" void

namespace uniform {
using Number = float;
using Int = std::int32_t;
#define AEROSOL_SYMBOL(name) AEROSOL_SMALL_FUNCTION u_##name
#define AEROSOL_LARGE(name) AEROSOL_LARGE_FUNCTION u_##name
#include "core/jit/runtime/symbols.inc"
#include "core/jit/runtime/symbols_gradient.inc"
#undef AEROSOL_SYMBOL
#undef AEROSOL_LARGE
}  // namespace uniform

#if defined(AEROSOL_DOMAIN_WIDE)

namespace wide {
using Number = Wide<float, AEROSOL_WIDTH>;
using Int = IntOf<Number>;
#define AEROSOL_SYMBOL(name) AEROSOL_SMALL_FUNCTION w_##name
#define AEROSOL_LARGE(name) AEROSOL_LARGE_FUNCTION w_##name
#include "core/jit/runtime/symbols.inc"
#include "core/jit/runtime/symbols_gradient.inc"
#undef AEROSOL_SYMBOL
#undef AEROSOL_LARGE
}  // namespace wide

#else

namespace range {
using Number = Form<Wide<float, AEROSOL_WIDTH>>;
using Int = IntRange<IntOf<Wide<float, AEROSOL_WIDTH>>>;
#define AEROSOL_SYMBOL(name) AEROSOL_LARGE_FUNCTION r_##name
#define AEROSOL_LARGE(name) AEROSOL_LARGE_FUNCTION r_##name
#include "core/jit/runtime/range_symbols.inc"
#include "core/jit/runtime/symbols.inc"
#include "core/jit/runtime/symbols_range_gradient.inc"
#undef AEROSOL_SYMBOL
#undef AEROSOL_LARGE
}  // namespace range

#endif

}  // namespace aerosol::jit::runtime

#if defined(AEROSOL_RUNTIME_AVX512_ATTRIBUTES)
#pragma clang attribute pop
#endif

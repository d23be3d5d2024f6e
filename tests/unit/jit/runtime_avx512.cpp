// Noise at 16 lanes by the instructions of AVX-512, for a test that has asked the processor. The runtime's namespace
// gets another name here: its inline functions are compiled for other processors elsewhere in the program.
#define runtime runtime_avx512
#define AEROSOL_RUNTIME_AVX512_ATTRIBUTES 1
#pragma clang attribute push(__attribute__((target("avx512f,avx512cd,avx512bw,avx512dq,avx512vl"))), \
                             apply_to = function)

#include "core/jit/runtime/noise_perlin.h"

namespace aerosol::jit::test {

void perlinByPermutation(const float* x, const float* y, const float* z, float* result) {
  using F = runtime::Wide<float, 16>;
  static_assert(runtime::hasTablePermute<F>);
  runtime::Triple<F> p;
  __builtin_memcpy(&p.x, x, sizeof(F));
  __builtin_memcpy(&p.y, y, sizeof(F));
  __builtin_memcpy(&p.z, z, sizeof(F));
  const F noise = runtime::perlin(p);
  __builtin_memcpy(result, &noise, sizeof(F));
}

}  // namespace aerosol::jit::test

#pragma clang attribute pop

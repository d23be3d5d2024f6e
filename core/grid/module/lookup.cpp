#include "core/grid/module/lookup.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace aerosol::grid {

namespace {

using Lanes = float __attribute__((ext_vector_type(16)));
using IntLanes = std::int32_t __attribute__((ext_vector_type(16)));
using DoubleLanes = double __attribute__((ext_vector_type(16)));

#if defined(__x86_64__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512vl,avx512dq,avx512bw"), min_vector_width(512))), \
                             apply_to = function)
namespace avx512 {
static inline void gather(const float* base, const IntLanes& at, Lanes& to) {
  to = reinterpret_cast<Lanes>(_mm512_i32gather_ps(reinterpret_cast<__m512i>(at), base, 4));
}
static inline void gather(const std::int32_t* base, const IntLanes& at, IntLanes& to) {
  to = reinterpret_cast<IntLanes>(_mm512_i32gather_epi32(reinterpret_cast<__m512i>(at), base, 4));
}
#include "core/grid/module/lookup_lanes.inc"
}  // namespace avx512
#pragma clang attribute pop
#endif

template <class T, class V>
inline void gather(const T* base, const IntLanes& at, V& to) {
  for (int l = 0; l < 16; ++l) to[l] = base[at[l]];
}

namespace plain {
#include "core/grid/module/lookup_lanes.inc"
}  // namespace plain

#if defined(__x86_64__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
namespace avx2 {
#include "core/grid/module/lookup_lanes.inc"
}  // namespace avx2
#pragma clang attribute pop
#endif

using LookupFunction = void(VoxelInterpolation, const LookupArguments&);

template <int channels>
LookupFunction* chooseFunction() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw")) {
    return avx512::lookUpAll<channels>;
  }
  if (__builtin_cpu_supports("avx2")) return avx2::lookUpAll<channels>;
#endif
  return plain::lookUpAll<channels>;
}

}  // namespace

void lookUp(VoxelInterpolation interpolation, const LookupArguments& arguments) {
  static LookupFunction* const single = chooseFunction<1>();
  static LookupFunction* const triple = chooseFunction<3>();
  (arguments.directory->channels == 1 ? single : triple)(interpolation, arguments);
}

}  // namespace aerosol::grid

// Lookups of 16 points at a time: what the functions that are compiled for each instruction set share. Internal to this
// layer; see instruction_sets.inc.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aerosol::grid {

using Lanes = float __attribute__((ext_vector_type(16)));
using IntLanes = std::int32_t __attribute__((ext_vector_type(16)));
using DoubleLanes = double __attribute__((ext_vector_type(16)));

/// Points of the file's space, and where the values go.
struct LookupPoints {
  const double* fileToIndex = nullptr;  ///< Rows of a map on column vectors: 12 numbers.
  const double* divisors = nullptr;     ///< Likewise, what each coordinate is to be divided by; null: by 1.
  std::size_t count = 0;
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  float* results = nullptr;      ///< Channel after channel.
  const float* times = nullptr;  ///< By point, of voxels in time (seconds).
};

/// The function for what the processor has. All of them give the same bits.
template <class Function>
Function* chooseByProcessor(Function* avx512, Function* avx2, Function* plain) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw")) {
    return avx512;
  }
  if (__builtin_cpu_supports("avx2")) return avx2;
#else
  static_cast<void>(avx512);
  static_cast<void>(avx2);
#endif
  return plain;
}

}  // namespace aerosol::grid

// The functions over a number type: a float, or a vector of floats with a mask for its branches. Included by the
// sources that are compiled for this machine alone, each with its own Lanes.
//
// Noise: gradients at lattice points picked by Bob Jenkins' lookup3 hash (2006), quintic fade (Perlin 2002), with the
// constants of Open Shading Language.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include "tests/bench/reference.h"

namespace aerosol::bench {
namespace {

template <int W>
struct Lanes {
  typedef float Float __attribute__((ext_vector_type(W)));
  typedef std::int32_t Int __attribute__((ext_vector_type(W)));
  typedef std::uint32_t Word __attribute__((ext_vector_type(W)));

  static Word rotate(Word x, unsigned k) { return (x << Word(k)) | (x >> Word(32 - k)); }
  static Word toWord(Float x) { return __builtin_convertvector(__builtin_convertvector(x, Int), Word); }
  static Float choose(Int mask, Float a, Float b) { return mask ? a : b; }
  static bool any(Int mask) { return __builtin_reduce_or(mask) != 0; }
  static Float flip(Float x, Word h, unsigned bit) {
    const Word bits = __builtin_bit_cast(Word, x) ^ ((h << Word(31 - bit)) & Word(0x80000000u));
    return __builtin_bit_cast(Float, bits);
  }
  static Float root(Float x) { return __builtin_elementwise_sqrt(x); }
  static Float floor(Float x) { return __builtin_elementwise_floor(x); }
  static Float fma(Float a, Float b, Float c) { return __builtin_elementwise_fma(a, b, c); }
  static Float absolute(Float x) { return __builtin_elementwise_abs(x); }
  static Float load(const float* p) { return *reinterpret_cast<const Float*>(p); }
  static void store(float* p, Float x) { *reinterpret_cast<Float*>(p) = x; }
};

template <>
struct Lanes<1> {
  using Float = float;
  using Int = std::int32_t;
  using Word = std::uint32_t;

  static Word rotate(Word x, unsigned k) { return (x << k) | (x >> (32 - k)); }
  static Word toWord(Float x) { return static_cast<Word>(static_cast<Int>(x)); }
  static Float choose(Int mask, Float a, Float b) { return mask ? a : b; }
  static bool any(Int mask) { return mask != 0; }
  static Float flip(Float x, Word h, unsigned bit) { return (h >> bit & 1) != 0 ? -x : x; }
  static Float root(Float x) { return __builtin_sqrtf(x); }
  static Float floor(Float x) { return __builtin_floorf(x); }
  static Float fma(Float a, Float b, Float c) { return __builtin_fmaf(a, b, c); }
  static Float absolute(Float x) { return __builtin_fabsf(x); }
  static Float load(const float* p) { return *p; }
  static void store(float* p, Float x) { *p = x; }
};

template <int W>
struct Functions {
  using L = Lanes<W>;
  using Float = typename L::Float;
  using Int = typename L::Int;
  using Word = typename L::Word;

  static Word hash(Word x, Word y, Word z) {
    const Word seed(0xdeadbeefu + (3u << 2) + 13u);
    Word a = seed + x, b = seed + y, c = seed + z;
    c ^= b, c -= L::rotate(b, 14);
    a ^= c, a -= L::rotate(c, 11);
    b ^= a, b -= L::rotate(a, 25);
    c ^= b, c -= L::rotate(b, 16);
    a ^= c, a -= L::rotate(c, 4);
    b ^= a, b -= L::rotate(a, 14);
    c ^= b, c -= L::rotate(b, 24);
    return c;
  }

  static Float gradient(Word hashed, Float x, Float y, Float z) {
#if defined(__AVX512F__)
    if constexpr (W == 16) {
      // Sixteen gradients are one register an axis.
      const __m512 gx = _mm512_setr_ps(1, -1, 1, -1, 1, -1, 1, -1, 0, 0, 0, 0, 1, 0, -1, 0);
      const __m512 gy = _mm512_setr_ps(1, 1, -1, -1, 0, 0, 0, 0, 1, -1, 1, -1, 1, -1, 1, -1);
      const __m512 gz = _mm512_setr_ps(0, 0, 0, 0, 1, 1, -1, -1, 1, 1, -1, -1, 0, 1, 0, -1);
      const auto pick = [&](__m512 table) {
        return __builtin_bit_cast(Float, _mm512_permutexvar_ps(__builtin_bit_cast(__m512i, hashed), table));
      };
      return L::fma(pick(gz), z, L::fma(pick(gy), y, pick(gx) * x));
    }
#endif
    const Word h = hashed & Word(15);
    const Float u = L::choose(h < Word(8), x, y);
    const Float v = L::choose(h < Word(4), y, L::choose((h == Word(12)) | (h == Word(14)), x, z));
    return L::flip(u, h, 0) + L::flip(v, h, 1);
  }

  static Float fade(Float t) { return t * t * t * L::fma(t, L::fma(t, Float(6), Float(-15)), Float(10)); }
  static Float mix(Float a, Float b, Float t) { return L::fma(t, b - a, a); }

  static Float noise(Float x, Float y, Float z) {
    const Float floorX = L::floor(x), floorY = L::floor(y), floorZ = L::floor(z);
    const Word i = L::toWord(floorX), j = L::toWord(floorY), k = L::toWord(floorZ);
    const Float fx = x - floorX, fy = y - floorY, fz = z - floorZ;
    const Float gx = fx - Float(1), gy = fy - Float(1), gz = fz - Float(1);
    const Float u = fade(fx), v = fade(fy), w = fade(fz);
    const Word one(1);
    const Float low =
        mix(mix(gradient(hash(i, j, k), fx, fy, fz), gradient(hash(i + one, j, k), gx, fy, fz), u),
            mix(gradient(hash(i, j + one, k), fx, gy, fz), gradient(hash(i + one, j + one, k), gx, gy, fz), u), v);
    const Float high = mix(
        mix(gradient(hash(i, j, k + one), fx, fy, gz), gradient(hash(i + one, j, k + one), gx, fy, gz), u),
        mix(gradient(hash(i, j + one, k + one), fx, gy, gz), gradient(hash(i + one, j + one, k + one), gx, gy, gz), u),
        v);
    return mix(low, high, w) * Float(0.982f);
  }

  static Float length(Float x, Float y, Float z) { return L::root(x * x + y * y + z * z); }

  static Float sphere(Float x, Float y, Float z) {
    const Float d = Float(1) - length(x, y, z);
    return L::choose(d > Float(0), d, Float(0));
  }

  static Float fbm(Float x, Float y, Float z) {
    Float sum(0), weight(0.5f);
    for (int octave = 0; octave < 6; ++octave) {
      sum += weight * noise(x, y, z);
      x *= Float(2), y *= Float(2), z *= Float(2);
      weight *= Float(0.5f);
    }
    return sum;
  }

  static Float pyroclastic(Float x, Float y, Float z) {
    const Float radius = length(x, y, z);
    const Int near = radius < Float(1.5f);
    Float result(0);
    if (!L::any(near)) return result;
    Float sum(0), weight(0.5f);
    for (int octave = 0; octave < 6; ++octave) {
      sum += weight * L::absolute(noise(x, y, z));
      x *= Float(2), y *= Float(2), z *= Float(2);
      weight *= Float(0.5f);
    }
    const Float d = Float(1) + sum - radius;
    return L::choose(near & (d > Float(0)), d, result);
  }

  template <Float (*function)(Float, Float, Float)>
  static void run(const float* x, const float* y, const float* z, float* result, std::size_t count) {
    for (std::size_t i = 0; i < count; i += W)
      L::store(result + i, function(L::load(x + i), L::load(y + i), L::load(z + i)));
  }

  static Reference reference() { return {&run<sphere>, &run<fbm>, &run<pyroclastic>}; }
};

}  // namespace
}  // namespace aerosol::bench

// Integer hashes of lattice points: Bob Jenkins' lookup3 (2006) for up to five 32-bit words, with the seeds that Open
// Shading Language uses, so that noise has the language's own values.
#pragma once

#include "core/jit/runtime/wide.h"

namespace aerosol::jit::runtime {

/// Seed of the hash of `count` words.
constexpr std::uint32_t hashSeed(std::uint32_t count) { return 0xdeadbeefu + (count << 2) + 13u; }

/// lookup3's final mixing.
template <UintLanes U>
AEROSOL_INLINE U hashFinal(U a, U b, U c) {
  c ^= b;
  c -= rotateLeft(b, 14);
  a ^= c;
  a -= rotateLeft(c, 11);
  b ^= a;
  b -= rotateLeft(a, 25);
  c ^= b;
  c -= rotateLeft(b, 16);
  a ^= c;
  a -= rotateLeft(c, 4);
  b ^= a;
  b -= rotateLeft(a, 14);
  c ^= b;
  c -= rotateLeft(b, 24);
  return c;
}

/// lookup3's mixing between blocks of three words.
template <UintLanes U>
AEROSOL_INLINE void hashMix(U& a, U& b, U& c) {
  a -= c;
  a ^= rotateLeft(c, 4);
  c += b;
  b -= a;
  b ^= rotateLeft(a, 6);
  a += c;
  c -= b;
  c ^= rotateLeft(b, 8);
  b += a;
  a -= c;
  a ^= rotateLeft(c, 16);
  c += b;
  b -= a;
  b ^= rotateLeft(a, 19);
  a += c;
  c -= b;
  c ^= rotateLeft(b, 4);
  b += a;
}

template <UintLanes U>
AEROSOL_INLINE U hashWords(U x) {
  const U seed = U(hashSeed(1));
  return hashFinal(x + seed, seed, seed);
}
template <UintLanes U>
AEROSOL_INLINE U hashWords(U x, U y) {
  const U seed = U(hashSeed(2));
  return hashFinal(x + seed, y + seed, seed);
}
template <UintLanes U>
AEROSOL_INLINE U hashWords(U x, U y, U z) {
  const U seed = U(hashSeed(3));
  return hashFinal(x + seed, y + seed, z + seed);
}
template <UintLanes U>
AEROSOL_INLINE U hashWords(U x, U y, U z, U w) {
  const U seed = U(hashSeed(4));
  U a = x + seed;
  U b = y + seed;
  U c = z + seed;
  hashMix(a, b, c);
  return hashFinal(a + w, b, c);
}
template <UintLanes U>
AEROSOL_INLINE U hashWords(U x, U y, U z, U w, U v) {
  const U seed = U(hashSeed(5));
  U a = x + seed;
  U b = y + seed;
  U c = z + seed;
  hashMix(a, b, c);
  return hashFinal(a + w, b + v, c);
}

/// To [0, 1].
template <UintLanes U>
AEROSOL_INLINE FloatOf<U> bitsToUnit(U bits) {
  return toFloat(bits) * FloatOf<U>(2.32830644e-10f);  // 1 / (2^32 - 1), which is 2^-32 as a float
}

}  // namespace aerosol::jit::runtime

#include "core/base/sobol.h"

#include "core/base/random.h"

// Padding two-dimensional Sobol' points to many dimensions: B. Burley, "Practical Hash-based Owen Scrambling" (JCGT
// 2020). Every pair of dimensions is the same two-dimensional sequence, visited in an order that is itself an Owen
// scrambling of the index (which keeps aligned runs of 2^m together, so each stays a net) and scrambled per coordinate.
// Valid as randomised quasi-Monte Carlo because each point alone is uniform whatever the index is.
//
// In the base-2 Sobol' construction the generator matrix of the first dimension is the identity and that of the second
// is Pascal's triangle modulo 2. That matrix is the fifth Kronecker power of (1 1; 0 1), so multiplying by it takes
// five masked shifts instead of a table of direction numbers.

namespace aerosol {

namespace {

/// Coefficient of x^i in the sum over bits j of (1 + x)^j, modulo 2: Pascal's matrix times the index, low bit first.
constexpr std::uint32_t multiplyByPascal(std::uint32_t x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  x ^= (x >> 16) & 0x0000ffffu;
  return x;
}

/// An Owen scrambling of a fraction written low bit first (Laine and Karras 2011, constants by Vegdahl 2021): a
/// permutation in which a bit is changed by lower bits and by the seed only.
constexpr std::uint32_t scrambleReversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

struct Seeds {
  std::uint32_t shuffle, first, second;
};

constexpr Seeds seedsOf(std::uint64_t key) {
  const std::uint64_t a = mixBits(key ^ 0x6a09e667f3bcc909u), b = mixBits(key + 0xbb67ae8584caa73bu);
  return {static_cast<std::uint32_t>(a >> 32), static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b >> 32)};
}

}  // namespace

std::array<std::uint32_t, 2> sobolPoint(std::uint32_t index) {
  return {reverseBits(index), reverseBits(multiplyByPascal(index))};
}

std::uint32_t owenScramble(std::uint32_t fraction, std::uint32_t seed) {
  return reverseBits(scrambleReversed(reverseBits(fraction), seed));
}

std::array<std::uint32_t, 2> scrambledSobol2D(std::uint32_t index, std::uint64_t key) {
  const Seeds seeds = seedsOf(key);
  const std::uint32_t shuffled = owenScramble(index, seeds.shuffle);
  return {reverseBits(scrambleReversed(shuffled, seeds.first)),
          reverseBits(scrambleReversed(multiplyByPascal(shuffled), seeds.second))};
}

std::uint32_t scrambledSobol1D(std::uint32_t index, std::uint64_t key) {
  const Seeds seeds = seedsOf(key);
  return reverseBits(scrambleReversed(owenScramble(index, seeds.shuffle), seeds.first));
}

}  // namespace aerosol

// Owen-scrambled Sobol' points, two dimensions at a time.
#pragma once

#include <array>
#include <cstdint>

namespace aerosol {

constexpr std::uint32_t reverseBits(std::uint32_t x) { return __builtin_bitreverse32(x); }

/// Point `index` of the two-dimensional Sobol' sequence, as 32-bit fractions. The first 2^m points, and every aligned
/// run of 2^m, are a (0, m, 2)-net in base 2.
std::array<std::uint32_t, 2> sobolPoint(std::uint32_t index);

/// Nested uniform scrambling (Owen 1995) of a 32-bit fraction: which half of an elementary interval comes first is
/// decided by a hash of `seed` and the bits above.
std::uint32_t owenScramble(std::uint32_t fraction, std::uint32_t seed);

/// The scrambled and shuffled point `index` of the pattern `key`, as 32-bit fractions. Patterns of different keys are
/// independent; within one the first 2^m points are a (0, m, 2)-net. Each coordinate is uniform.
std::array<std::uint32_t, 2> scrambledSobol2D(std::uint32_t index, std::uint64_t key);

/// One dimension alone: every elementary interval of length 2^-m holds one of the first 2^m points.
std::uint32_t scrambledSobol1D(std::uint32_t index, std::uint64_t key);

}  // namespace aerosol

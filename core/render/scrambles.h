// Which samples of a pixel are scrambled together.
#pragma once

#include <cstdint>

namespace aerosol::render {

/// The points of one low-discrepancy pattern depend on each other: how they scatter does not tell how far their mean is
/// from the truth. Patterns that are scrambled independently do (Owen 1997, "Monte Carlo variance of scrambled net
/// quadrature", section 7: replicates). So a pixel has eight. They take turns at eight samples each: the first 64 hold
/// eight of each, and every power of two of blocks of 64 is a whole net of each pattern.
inline constexpr std::uint32_t scrambleCount = 8, scrambleRun = 8;

/// The pattern that a sample of the pixel belongs to, below scrambleCount.
constexpr std::uint32_t scrambleOf(std::uint32_t sample) { return sample / scrambleRun % scrambleCount; }

/// Its number within that pattern.
constexpr std::uint32_t indexInScramble(std::uint32_t sample) {
  return sample / (scrambleRun * scrambleCount) * scrambleRun + sample % scrambleRun;
}

/// How many of the samples 0 ≤ i < `end` belong to a pattern.
constexpr std::uint64_t countOfScramble(std::uint64_t end, std::uint32_t scramble) {
  constexpr std::uint64_t round = scrambleRun * scrambleCount;
  const std::uint64_t rest = end % round, before = std::uint64_t{scramble} * scrambleRun;
  const std::uint64_t last = rest <= before ? 0 : rest - before < scrambleRun ? rest - before : scrambleRun;
  return end / round * scrambleRun + last;
}

/// Of all that can be told from how the sums of the eight scatter a pixel keeps four contrasts, which take half of the
/// memory: in each, four of the sums count as positive and four as negative (Walsh functions).
inline constexpr std::uint32_t contrastCount = 4;

/// 1 or -1.
constexpr int contrastSign(std::uint32_t contrast, std::uint32_t scramble) {
  constexpr std::uint32_t masks[contrastCount] = {1, 2, 4, 7};
  return (__builtin_popcount(scramble & masks[contrast]) & 1) != 0 ? -1 : 1;
}

}  // namespace aerosol::render

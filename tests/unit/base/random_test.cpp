#include "core/base/random.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

namespace aerosol {
namespace {

TEST(Random, IsAFunctionOfItsArgumentsAlone) {
  constexpr std::uint64_t key = pixelKey(1, 2, 3);
  static_assert(randomBits(key, 4, 5) == randomBits(pixelKey(1, 2, 3), 4, 5));
  std::set<std::uint64_t> seen;
  for (const std::uint64_t k : {pixelKey(0, 0, 0), pixelKey(1, 0, 0), pixelKey(0, 1, 0), pixelKey(0, 0, 1)}) {
    for (std::uint32_t sample = 0; sample < 50; ++sample) {
      for (std::uint32_t dimension = 0; dimension < 50; ++dimension) seen.insert(randomBits(k, sample, dimension));
    }
  }
  EXPECT_EQ(seen.size(), 4u * 50 * 50);
}

TEST(Random, FloatsFillTheUnitIntervalWithoutItsEnd) {
  EXPECT_EQ(unitFloat(std::uint32_t{0}), 0.0f);
  EXPECT_EQ(unitFloat(~std::uint32_t{0}), 0x1.fffffep-1f);
  EXPECT_EQ(unitFloat(~std::uint64_t{0}), 0x1.fffffep-1f);
  EXPECT_EQ(unitFloat(std::uint32_t{1} << 31), 0.5f);
}

/// Each flipped bit of sample, dimension or pixel flips each output bit with probability 1/2, for counters as they
/// occur.
TEST(Random, Avalanche) {
  constexpr int trials = 4096;
  for (int flipped = 0; flipped < 96; ++flipped) {
    int flips[64] = {};
    for (int trial = 0; trial < trials; ++trial) {
      const auto sample = static_cast<std::uint32_t>(trial % 64), dimension = static_cast<std::uint32_t>(trial / 64);
      const std::uint32_t bit = 1u << (flipped % 32);
      const std::uint64_t before = randomBits(pixelKey(7, 100, 50), sample, dimension);
      const std::uint64_t after = flipped < 32   ? randomBits(pixelKey(7, 100, 50), sample ^ bit, dimension)
                                  : flipped < 64 ? randomBits(pixelKey(7, 100, 50), sample, dimension ^ bit)
                                                 : randomBits(pixelKey(7 ^ bit, 100, 50), sample, dimension);
      for (int i = 0; i < 64; ++i) flips[i] += static_cast<int>((before ^ after) >> i & 1u);
    }
    for (int i = 0; i < 64; ++i) EXPECT_NEAR(flips[i], trials / 2, 6 * std::sqrt(trials / 4.0)) << flipped << ' ' << i;
  }
}

}  // namespace
}  // namespace aerosol

#include "core/base/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "core/base/random.h"

namespace aerosol {
namespace {

using Points = std::vector<std::array<std::uint32_t, 2>>;

/// Every box 2^-a × 2^-(m-a) of a grid of elementary intervals holds exactly one of the 2^m points.
::testing::AssertionResult isNet(const Points& points, int m) {
  for (int a = 0; a <= m; ++a) {
    std::vector<int> counts(std::size_t{1} << m);
    for (const auto& [x, y] : points) {
      const std::size_t column = a == 0 ? 0 : x >> (32 - a);
      const std::size_t row = a == m ? 0 : y >> (32 - (m - a));
      if (++counts[(column << (m - a)) | row] > 1) {
        return ::testing::AssertionFailure() << "two points in a box of 2^-" << a << " by 2^-" << m - a;
      }
    }
  }
  return ::testing::AssertionSuccess();
}

TEST(Sobol, SecondDimensionFollowsTheRecursionOfItsDirectionNumbers) {
  for (std::uint32_t index = 0; index < 5000; ++index) {
    std::uint32_t expected = 0, direction = 1u << 31;
    for (std::uint32_t rest = index; rest != 0; rest >>= 1, direction ^= direction >> 1) {
      if ((rest & 1u) != 0) expected ^= direction;
    }
    ASSERT_EQ(sobolPoint(index)[1], expected) << index;
    ASSERT_EQ(sobolPoint(index)[0], reverseBits(index));
  }
}

TEST(Sobol, ScrambledPointsAreNets) {
  for (int m = 0; m <= 10; ++m) {
    for (std::uint64_t pattern = 0; pattern < 8; ++pattern) {
      for (const std::uint32_t run : {0u, 1u, 5u}) {
        Points points;
        for (std::uint32_t i = 0; i < 1u << m; ++i)
          points.push_back(scrambledSobol2D((run << m) + i, mixBits(pattern)));
        EXPECT_TRUE(isNet(points, m)) << "m " << m << " pattern " << pattern << " run " << run;
      }
    }
  }
}

TEST(Sobol, TheNetTestSeesAWrongPoint) {
  Points points;
  for (std::uint32_t i = 0; i < 64; ++i) points.push_back(scrambledSobol2D(i, 99));
  ASSERT_TRUE(isNet(points, 6));
  points[17][1] ^= 1u << 26;
  EXPECT_FALSE(isNet(points, 6));
}

TEST(Sobol, OneDimensionIsStratified) {
  for (std::uint64_t pattern = 0; pattern < 8; ++pattern) {
    std::set<std::uint32_t> cells;
    for (std::uint32_t i = 0; i < 1024; ++i) cells.insert(scrambledSobol1D(i, mixBits(pattern)) >> 22);
    EXPECT_EQ(cells.size(), 1024u);
  }
}

/// A nested scrambling permutes: bits above the first difference stay equal in two outputs, and the first one differs.
TEST(Sobol, OwenScramblingIsNested) {
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto a = static_cast<std::uint32_t>(mixBits(i)), seed = static_cast<std::uint32_t>(mixBits(i + 1000000));
    const std::uint32_t b = a ^ static_cast<std::uint32_t>(mixBits(i + 2000000) >> 32 >> (i % 32));
    if (a == b) continue;
    ASSERT_EQ(__builtin_clz(owenScramble(a, seed) ^ owenScramble(b, seed)), __builtin_clz(a ^ b));
  }
}

/// Over patterns each single point is uniform, so every estimate is unbiased.
TEST(Sobol, EveryIndexIsUniformOverPatterns) {
  constexpr int patterns = 1 << 14;
  for (const std::uint32_t index : {0u, 1u, 2u, 63u, 4096u}) {
    double mean[2] = {};
    int cells[16][16] = {};
    for (std::uint64_t pattern = 0; pattern < patterns; ++pattern) {
      const std::array<std::uint32_t, 2> p = scrambledSobol2D(index, mixBits(pattern));
      for (std::size_t d = 0; d < 2; ++d) mean[d] += p[d] * 0x1p-32 / patterns;
      ++cells[p[0] >> 28][p[1] >> 28];
    }
    for (const double m : mean) EXPECT_NEAR(m, 0.5, 5 * std::sqrt(1.0 / 12 / patterns));
    double chi2 = 0;
    for (const auto& row : cells) {
      for (const int count : row) chi2 += (count - 64.0) * (count - 64.0) / 64;
    }
    EXPECT_LT(chi2, 255 + 6 * std::sqrt(2 * 255.0)) << index;
  }
}

/// The padded dimensions are independent: points of two patterns fill the square of their first coordinates as random
/// ones do, neither aligned nor stratified against each other.
TEST(Sobol, PatternsAreIndependentOfEachOther) {
  constexpr std::uint32_t points = 1 << 14;
  for (std::uint64_t other = 1; other < 6; ++other) {
    int cells[16][16] = {};
    double product = 0;
    for (std::uint32_t i = 0; i < points; ++i) {
      const std::uint32_t x = scrambledSobol2D(i, combineHashes(3, 0))[0],
                          y = scrambledSobol2D(i, combineHashes(3, other))[1];
      ++cells[x >> 28][y >> 28];
      product += (x * 0x1p-32 - 0.5) * (y * 0x1p-32 - 0.5);
    }
    double chi2 = 0;
    for (const auto& row : cells) {
      for (const int count : row) chi2 += (count - 64.0) * (count - 64.0) / 64;
    }
    EXPECT_LT(chi2, 255 + 6 * std::sqrt(2 * 255.0)) << other;
    EXPECT_LT(std::fabs(product), 5 * std::sqrt(points) / 12) << other;
  }
}

}  // namespace
}  // namespace aerosol

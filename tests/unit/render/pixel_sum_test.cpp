#include "core/render/pixel_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/random.h"

namespace aerosol::render {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Values over many magnitudes and of both signs, so that any other order of addition shows.
PixelSample sampleAt(std::uint32_t i) {
  const auto value = [&](std::uint32_t d) {
    const float u = randomFloat(17, i, 2 * d);
    return (u - 0.3f) * std::exp2(40 * randomFloat(17, i, 2 * d + 1) - 20);
  };
  return {{value(0), value(1), value(2)}, randomFloat(17, i, 9)};
}

void fill(PixelSum& pixel, std::uint32_t first, std::uint32_t end) {
  for (std::uint32_t i = first; i < end; ++i) ASSERT_TRUE(pixel.add(i, sampleAt(i)));
}

/// The definition, recursively: the sum of blocks [first, first + count), count a power of two, of samples below `end`.
SampleSums tree(std::uint32_t first, std::uint32_t count, std::uint32_t end) {
  if (count > 1) return tree(first, count / 2, end) + tree(first + count / 2, count / 2, end);
  SampleSums sum;
  for (std::uint32_t i = first * 64; i < std::min(end, first * 64 + 64); ++i) sum.add(sampleAt(i), i);
  return sum;
}

TEST(PixelSum, AddsBlocksInOneTree) {
  for (const std::uint32_t blocks : {1u, 2u, 4u, 8u, 64u}) {
    PixelSum pixel;
    fill(pixel, 0, blocks * 64);
    EXPECT_EQ(pixel.total(), tree(0, blocks, blocks * 64));
  }
  PixelSum pixel;
  fill(pixel, 0, 7 * 64 + 5);
  EXPECT_EQ(pixel.total(), tree(0, 4, 512) + (tree(4, 2, 512) + (tree(6, 1, 512) + tree(7, 1, 7 * 64 + 5))));
}

TEST(PixelSum, AnyOrderGivesTheSameBits) {
  PixelSum reference;
  fill(reference, 0, 300);
  for (std::uint32_t trial = 0; trial < 30; ++trial) {
    std::vector<std::uint32_t> order(300);
    std::iota(order.begin(), order.end(), 0u);
    for (std::uint32_t i = 299; i > 0; --i) std::swap(order[i], order[randomBits(trial, i, 0) % (i + 1)]);
    PixelSum pixel;
    for (const std::uint32_t i : order) ASSERT_TRUE(pixel.add(i, sampleAt(i)));
    ASSERT_EQ(pixel, reference);
    ASSERT_EQ(pixel.ranges(), reference.ranges());
    ASSERT_LE(pixel.bytes(), reference.bytes() + 1024) << "open samples are given back";
  }
}

/// Every split of [0, end) at the cuts, merged in every order.
void expectSplitsAgree(const std::vector<std::uint32_t>& cuts) {
  PixelSum reference;
  fill(reference, cuts.front(), cuts.back());
  std::vector<std::size_t> order(cuts.size() - 1);
  std::iota(order.begin(), order.end(), std::size_t{0});
  do {
    PixelSum merged;
    for (const std::size_t part : order) {
      PixelSum pixel;
      fill(pixel, cuts[part], cuts[part + 1]);
      ASSERT_TRUE(merged.merge(pixel));
    }
    ASSERT_EQ(merged, reference);
    ASSERT_EQ(merged.total(), reference.total());
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(PixelSum, UnevenSplitsMergeToTheSameBits) {
  expectSplitsAgree({0, 7, 100, 256});
  expectSplitsAgree({0, 64, 128, 192, 256});
  expectSplitsAgree({0, 1, 2, 3, 300});
  expectSplitsAgree({5, 64, 65, 127, 400, 1000});
  expectSplitsAgree({0, 63, 129, 130, 1025});
}

TEST(PixelSum, MergesOfMergesAgree) {
  PixelSum reference, left, right;
  fill(reference, 0, 500);
  for (std::uint32_t first = 0; first < 500; first += 20) {
    PixelSum part;
    fill(part, first, first + 20);
    ASSERT_TRUE((first / 20 % 3 == 0 ? left : right).merge(part));
  }
  ASSERT_TRUE(right.merge(left));
  EXPECT_EQ(right, reference);
  EXPECT_EQ(right.ranges(), reference.ranges());
}

TEST(PixelSum, ASampleIsTakenOnce) {
  PixelSum pixel, other;
  fill(pixel, 0, 100);
  pixel.add(120, sampleAt(120));
  const SampleSums before = pixel.total();
  for (const std::uint32_t i : {0u, 63u, 64u, 99u, 120u}) EXPECT_FALSE(pixel.add(i, sampleAt(i)));
  other.add(120, sampleAt(120));
  other.add(200, sampleAt(200));
  EXPECT_TRUE(pixel.overlaps(other));
  EXPECT_FALSE(pixel.merge(other));
  EXPECT_EQ(pixel.total(), before);
  EXPECT_EQ(pixel.count(), 101u);
}

TEST(PixelSum, NonFiniteSamplesAreDroppedAndCounted) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  PixelSum pixel;
  SampleSums sums;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const PixelSample bad = i % 20 == 3 ? PixelSample{{1, nan, 1}, 1} : PixelSample{{1, 1, 1}, infinity};
    const bool isBad = i % 10 == 3;
    if (!isBad) sums.add(sampleAt(i), i);
    ASSERT_TRUE(pixel.add(i, isBad ? bad : sampleAt(i)));
  }
  EXPECT_EQ(pixel.dropped(), 7u);
  EXPECT_EQ(pixel.count(), 57u);
  EXPECT_EQ(pixel.total(), sums);
  EXPECT_EQ(pixel.ranges(), (std::vector<PixelSum::Range>{{0, 64}}));
}

TEST(PixelSum, DroppedSamplesKeepTheirPlaceInAnyOrder) {
  const auto valueAt = [](std::uint32_t i) { return i % 9 == 4 ? PixelSample{{nan, 0, 0}, 0} : sampleAt(i); };
  PixelSum forward, backward;
  for (std::uint32_t i = 0; i < 200; ++i) forward.add(i, valueAt(i));
  for (std::uint32_t i = 200; i-- > 0;) backward.add(i, valueAt(i));
  EXPECT_EQ(forward, backward);
  EXPECT_EQ(forward.dropped(), 22u);
}

TEST(PixelSum, SmallSamplesAreNotLostBesideLargeOnes) {
  // A running sum in double would lose every 1e-20 beside 1e20, and so does the tree: what must hold is the relative
  // error of the sum, for a million terms of one size and for one term that dwarfs the others.
  constexpr std::uint32_t n = 1 << 20;
  PixelSum small, mixed;
  for (std::uint32_t i = 0; i < n; ++i) {
    const float value = i == 77777 ? 1e20f : 1e-20f;
    small.add(i, {Color(1e-20f), 1});
    mixed.add(i, {Color(value, i % 2 == 0 ? 1e20f : -1e20f, 0.1f), 1});
  }
  EXPECT_NEAR(small.total().color[0] / (n * static_cast<double>(1e-20f)), 1, 1e-14);
  EXPECT_NEAR(mixed.total().color[0] / static_cast<double>(1e20f), 1, 1e-15);
  EXPECT_EQ(mixed.total().color[1], 0);
  EXPECT_NEAR(mixed.total().color[2] / (n * static_cast<double>(0.1f)), 1, 1e-14);
}

TEST(PixelSum, TheCommonCaseIsSmall) {
  PixelSum pixel;
  fill(pixel, 0, 256);
  EXPECT_EQ(pixel.bytes(), sizeof(PixelSum));
  EXPECT_LE(sizeof(PixelSum), 128u);
  fill(pixel, 256, 4032);
  EXPECT_LE(pixel.bytes(), 128u + 48 + 8 * 112);
  fill(pixel, 4032, 4096);
  EXPECT_EQ(pixel.bytes(), sizeof(PixelSum)) << "one node again";
}

}  // namespace
}  // namespace aerosol::render

#include "core/render/sample_stream.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace aerosol::render {
namespace {

std::vector<float> numbers(SampleStream stream) {
  std::vector<float> all;
  for (int i = 0; i < 100; ++i) {
    all.push_back(stream.next1D());
    for (const float u : stream.next2D()) all.push_back(u);
    all.push_back(stream.nextHash());
  }
  return all;
}

class SampleStreamOfKind : public ::testing::TestWithParam<SamplerKind> {
 protected:
  SampleStream stream(int x, int y, std::uint32_t sample, std::uint64_t seed = 5) const {
    return SamplerSettings{GetParam(), seed}.stream(x, y, sample);
  }
};

TEST_P(SampleStreamOfKind, DependsOnSeedPixelAndSampleAlone) {
  EXPECT_EQ(numbers(stream(3, 4, 7)), numbers(stream(3, 4, 7)));
  for (const SampleStream& other : {stream(4, 3, 7), stream(3, 4, 8), stream(3, 4, 7, 6)}) {
    const std::vector<float> a = numbers(stream(3, 4, 7)), b = numbers(other);
    int equal = 0;
    for (std::size_t i = 0; i < a.size(); ++i) equal += a[i] == b[i] ? 1 : 0;
    EXPECT_LE(equal, 1);
  }
}

TEST_P(SampleStreamOfKind, LiesInTheUnitInterval) {
  for (std::uint32_t sample = 0; sample < 200; ++sample) {
    for (const float u : numbers(stream(1, 1, sample))) {
      ASSERT_GE(u, 0.0f);
      ASSERT_LT(u, 1.0f);
    }
  }
}

TEST_P(SampleStreamOfKind, CopiesGoOnAlike) {
  SampleStream a = stream(0, 0, 0);
  a.next2D();
  SampleStream b = a;
  EXPECT_EQ(numbers(a), numbers(b));
}

TEST_P(SampleStreamOfKind, SlotsHaveTheirNumbersWhateverWasDrawnBefore) {
  SampleStream a = stream(2, 2, 9), b = a;
  for (int i = 0; i < 10; ++i) a.next1D();
  for (int i = 0; i < 33; ++i) a.nextHash();
  a.skipTo(20);
  b.skipTo(20);
  EXPECT_EQ(a.next2D(), b.next2D());
  EXPECT_EQ(a.slot(), 21u);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SampleStreamOfKind, ::testing::Values(SamplerKind::independent, SamplerKind::sobol));

TEST(SampleStream, SobolSlotsAreStratifiedOverTheSamplesOfAScramble) {
  constexpr std::uint32_t points = 64;
  for (std::uint32_t slot = 0; slot < SampleStream::stratifiedSlots; ++slot) {
    std::array<std::set<int>, scrambleCount> columns, squares;
    std::set<float> all;
    for (std::uint32_t sample = 0; sample < points * scrambleCount; ++sample) {
      SampleStream stream(SamplerKind::sobol, 1, 10, 20, sample);
      stream.skipTo(slot);
      const float u = SampleStream(stream).next1D();
      all.insert(u);
      columns[scrambleOf(sample)].insert(static_cast<int>(u * points));
      const auto [x, y] = stream.next2D();
      squares[scrambleOf(sample)].insert(static_cast<int>(x * 8) * 8 + static_cast<int>(y * 8));
    }
    for (std::uint32_t k = 0; k < scrambleCount; ++k) {
      ASSERT_EQ(columns[k].size(), points) << slot;
      ASSERT_EQ(squares[k].size(), points) << slot;
    }
    ASSERT_EQ(all.size(), points * scrambleCount) << "no scramble is another one over again";
  }
}

TEST(Scrambles, TakeTurnsAndCountTheirSamples) {
  std::array<std::uint64_t, scrambleCount> counts{};
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const std::uint32_t k = scrambleOf(i);
    ASSERT_EQ(indexInScramble(i), counts[k]) << "none is left out";
    ++counts[k];
    for (std::uint32_t j = 0; j < scrambleCount; ++j) ASSERT_EQ(countOfScramble(i + 1, j), counts[j]) << i;
    const bool isWhole = (i + 1) % 64 == 0;
    if (isWhole) ASSERT_EQ(counts.front(), counts.back());
  }
}

}  // namespace
}  // namespace aerosol::render

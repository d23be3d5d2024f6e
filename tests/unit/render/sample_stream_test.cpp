#include "core/render/sample_stream.h"

#include <gtest/gtest.h>

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

TEST(SampleStream, SobolSlotsAreStratifiedOverTheSamplesOfAPixel) {
  constexpr std::uint32_t samples = 256;
  for (std::uint32_t slot = 0; slot < SampleStream::stratifiedSlots; ++slot) {
    std::set<int> columns, squares;
    for (std::uint32_t sample = 0; sample < samples; ++sample) {
      SampleStream stream(SamplerKind::sobol, 1, 10, 20, sample);
      stream.skipTo(slot);
      columns.insert(static_cast<int>(SampleStream(stream).next1D() * samples));
      const auto [x, y] = stream.next2D();
      squares.insert(static_cast<int>(x * 16) * 16 + static_cast<int>(y * 16));
    }
    ASSERT_EQ(columns.size(), samples) << slot;
    ASSERT_EQ(squares.size(), samples) << slot;
  }
}

}  // namespace
}  // namespace aerosol::render

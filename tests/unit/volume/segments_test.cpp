#include "core/volume/segments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aerosol::volume {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// The media at one place, by the definition of a span: in the order of the spans.
std::vector<const Medium*> mediaAt(std::span<const MediumSpan> spans, double t) {
  std::vector<const Medium*> media;
  for (const MediumSpan& span : spans) {
    if (static_cast<double>(span.t0) < t && t < static_cast<double>(span.t1)) media.push_back(span.medium);
  }
  return media;
}

std::vector<const Medium*> mediaAt(const SegmentList& list, double t) {
  std::vector<const Medium*> media;
  for (const Segment& segment : list.segments()) {
    if (static_cast<double>(segment.t0) < t && t < static_cast<double>(segment.t1)) {
      media.insert(media.end(), segment.media.begin(), segment.media.end());
    }
  }
  return media;
}

/// Everything that a list of segments promises about the spans it was made from.
void expectSplits(const SegmentList& list, std::span<const MediumSpan> spans) {
  double previous = -infinity;
  std::vector<double> ends{-1e30f, 1e30f};
  for (const Segment& segment : list.segments()) {
    EXPECT_LT(segment.t0, segment.t1);
    EXPECT_GE(segment.t0, previous) << "segments overlap or are not in order";
    EXPECT_THAT(segment.media, Not(IsEmpty()));
    previous = segment.t1;
  }
  for (const MediumSpan& span : spans) {
    ends.push_back(span.t0);
    ends.push_back(span.t1);
  }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double middle = 0.5 * (ends[i] + ends[i + 1]);
    if (!(ends[i] < middle && middle < ends[i + 1])) continue;
    ASSERT_EQ(mediaAt(list, middle), mediaAt(spans, middle)) << "at " << middle;
  }
}

class Segments : public ::testing::Test {
 protected:
  const Medium* medium(std::size_t i) const { return &media_[i]; }

  SegmentList list_;

 private:
  std::vector<Medium> media_ = std::vector<Medium>(1000);
};

TEST_F(Segments, NothingGivesNothing) {
  list_.assign({});
  EXPECT_THAT(list_.segments(), IsEmpty());
}

TEST_F(Segments, OverlapIsSplitAtBothEnds) {
  const MediumSpan spans[] = {{1, 3, medium(0)}, {2, 5, medium(1)}};
  list_.assign(spans);
  ASSERT_EQ(list_.segments().size(), 3u);
  EXPECT_THAT(list_.segments()[0].media, ElementsAre(medium(0)));
  EXPECT_THAT(list_.segments()[1].media, ElementsAre(medium(0), medium(1)));
  EXPECT_THAT(list_.segments()[2].media, ElementsAre(medium(1)));
  EXPECT_EQ(list_.segments()[0].t0, 1);
  EXPECT_EQ(list_.segments()[1].t0, 2);
  EXPECT_EQ(list_.segments()[1].t1, 3);
  EXPECT_EQ(list_.segments()[2].t1, 5);
}

TEST_F(Segments, MediaKeepTheOrderOfTheSpans) {
  const MediumSpan spans[] = {{0, 4, medium(7)}, {-1, 9, medium(2)}, {1, 2, medium(5)}};
  list_.assign(spans);
  const std::vector<const Medium*> expected{medium(7), medium(2), medium(5)};
  EXPECT_EQ(mediaAt(list_, 1.5), expected);
  expectSplits(list_, spans);
}

TEST_F(Segments, ZeroLengthAndReversedSpansVanish) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const MediumSpan spans[] = {
      {1, 1, medium(0)}, {3, 2, medium(1)}, {infinity, infinity, medium(2)}, {nan, 1, medium(3)}, {0, nan, medium(4)}};
  list_.assign(spans);
  EXPECT_THAT(list_.segments(), IsEmpty());
  const MediumSpan withOne[] = {spans[0], {0, 2, medium(5)}, spans[1], spans[3]};
  list_.assign(withOne);
  ASSERT_EQ(list_.segments().size(), 1u) << "a span without length must not split others";
  EXPECT_THAT(list_.segments()[0].media, ElementsAre(medium(5)));
}

TEST_F(Segments, TouchingSpansStayApartAndGapsAreEmpty) {
  const MediumSpan spans[] = {{0, 1, medium(0)}, {1, 2, medium(1)}, {3, 4, medium(2)}};
  list_.assign(spans);
  ASSERT_EQ(list_.segments().size(), 3u);
  for (const Segment& segment : list_.segments()) EXPECT_EQ(segment.media.size(), 1u);
  EXPECT_EQ(list_.segments()[1].t1, 2);
  EXPECT_EQ(list_.segments()[2].t0, 3);
}

TEST_F(Segments, CoincidentEndsOfThree) {
  const MediumSpan spans[] = {{0, 2, medium(0)}, {2, 5, medium(1)}, {1, 2, medium(2)}, {2, 3, medium(3)}};
  list_.assign(spans);
  expectSplits(list_, spans);
  EXPECT_EQ(list_.segments().size(), 4u);
}

TEST_F(Segments, InfiniteSpan) {
  const MediumSpan spans[] = {{0, infinity, medium(0)}, {5, 6, medium(1)}};
  list_.assign(spans);
  ASSERT_EQ(list_.segments().size(), 3u);
  EXPECT_EQ(list_.segments()[2].t1, infinity);
  EXPECT_THAT(list_.segments()[1].media, ElementsAre(medium(0), medium(1)));
}

TEST_F(Segments, NeighbouringFloatsFarOut) {
  const float t0 = 1e6f, t1 = std::nextafter(t0, infinity), t2 = std::nextafter(t1, infinity);
  const MediumSpan spans[] = {{t0, t2, medium(0)}, {t1, t2, medium(1)}};
  list_.assign(spans);
  ASSERT_EQ(list_.segments().size(), 2u);
  EXPECT_EQ(list_.segments()[0].t1, t1);
}

TEST_F(Segments, RandomSetsOnAGridWithManyCoincidences) {
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    std::vector<MediumSpan> spans(random() % 12);
    for (MediumSpan& span : spans) {
      const auto a = static_cast<float>(random() % 10), b = static_cast<float>(random() % 10);
      span = {std::min(a, b), std::max(a, b), medium(random() % 4)};
    }
    list_.assign(spans);
    expectSplits(list_, spans);
  }
}

TEST_F(Segments, RandomSetsInGeneralPosition) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> place(-100, 100);
  for (int round = 0; round < 300; ++round) {
    std::vector<MediumSpan> spans(1 + random() % 40);
    std::size_t i = 0;
    for (MediumSpan& span : spans) {
      const float a = place(random), b = place(random);
      span = {std::min(a, b), std::max(a, b), medium(i++)};
    }
    list_.assign(spans);
    expectSplits(list_, spans);
  }
}

TEST_F(Segments, AThousandIdenticalAreOneSegment) {
  std::vector<MediumSpan> spans;
  for (std::size_t i = 0; i < 1000; ++i) spans.push_back({2, 3, medium(i)});
  list_.assign(spans);
  ASSERT_EQ(list_.segments().size(), 1u);
  EXPECT_EQ(list_.segments()[0].media.size(), 1000u);
  EXPECT_EQ(list_.segments()[0].media[999], medium(999));
}

TEST_F(Segments, AThousandNested) {
  std::vector<MediumSpan> spans;
  for (std::size_t i = 0; i < 1000; ++i) {
    spans.push_back({static_cast<float>(i), static_cast<float>(3000 - i), medium(i)});
  }
  list_.assign(spans);
  const std::span<const Segment> segments = list_.segments();
  ASSERT_EQ(segments.size(), 1999u);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    EXPECT_EQ(segments[i].media.size(), i < 1000 ? i + 1 : 1999 - i);
    EXPECT_EQ(segments[i].media.back(), medium(segments[i].media.size() - 1));
  }
}

TEST_F(Segments, NothingIsLeftOfThePreviousRay) {
  const MediumSpan many[] = {{0, 4, medium(0)}, {1, 5, medium(1)}, {2, 6, medium(2)}};
  const MediumSpan one[] = {{7, 8, medium(3)}};
  list_.assign(many);
  list_.assign(one);
  ASSERT_EQ(list_.segments().size(), 1u);
  EXPECT_THAT(list_.segments()[0].media, ElementsAre(medium(3)));
}

}  // namespace
}  // namespace aerosol::volume

#include "core/volume/segment_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aerosol::volume {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Spans in the order of a source: by t0, then as they were given.
std::vector<MediumSpan> sorted(std::span<const MediumSpan> spans) {
  std::vector<MediumSpan> result;
  for (const MediumSpan& span : spans) {
    result.insert(std::ranges::upper_bound(result, span.t0, {}, &MediumSpan::t0), span);
  }
  return result;
}

/// Gives out spans that are all known.
class KnownSpans final : public SpanSource {
 public:
  explicit KnownSpans(std::span<const MediumSpan> spans) : spans_(sorted(spans)) {}
  const MediumSpan* peek(double limit) override {
    farthest_ = std::max(farthest_, limit);
    return next_ < spans_.size() && spans_[next_].t0 < limit ? &spans_[next_] : nullptr;
  }
  void pop() override { ++next_; }
  /// The farthest place up to which spans were asked for.
  double farthest() const { return farthest_; }
  std::size_t taken() const { return next_; }

 private:
  std::vector<MediumSpan> spans_;
  std::size_t next_ = 0;
  double farthest_ = -1e30;
};

/// All segments of a stream, each with a copy of its media.
class AllSegments {
 public:
  void assign(std::span<const MediumSpan> spans) {
    KnownSpans source(spans);
    stream_.begin(source);
    segments_.clear();
    media_.clear();
    Segment segment;
    while (stream_.next(segment)) {
      media_.emplace_back(segment.media.begin(), segment.media.end());
      segments_.push_back(segment);
    }
    for (std::size_t i = 0; i < segments_.size(); ++i) segments_[i].media = media_[i];
  }
  std::span<const Segment> segments() const { return segments_; }

 private:
  SegmentStream stream_;
  std::vector<Segment> segments_;
  std::vector<std::vector<const Medium*>> media_;
};

/// The media at one place, by the definition of a span: in the order of the spans.
std::vector<const Medium*> mediaAt(std::span<const MediumSpan> spans, double t) {
  std::vector<const Medium*> media;
  for (const MediumSpan& span : spans) {
    if (static_cast<double>(span.t0) < t && t < static_cast<double>(span.t1)) media.push_back(span.medium);
  }
  return media;
}

std::vector<const Medium*> mediaAt(const AllSegments& list, double t) {
  std::vector<const Medium*> media;
  for (const Segment& segment : list.segments()) {
    if (static_cast<double>(segment.t0) < t && t < static_cast<double>(segment.t1)) {
      media.insert(media.end(), segment.media.begin(), segment.media.end());
    }
  }
  return media;
}

/// Everything that a list of segments promises about the spans it was made from.
void expectSplits(const AllSegments& list, std::span<const MediumSpan> spans) {
  const std::vector<MediumSpan> order = sorted(spans);
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
    ASSERT_EQ(mediaAt(list, middle), mediaAt(order, middle)) << "at " << middle;
  }
}

class Segments : public ::testing::Test {
 protected:
  const Medium* medium(std::size_t i) const { return &media_[i]; }

  AllSegments list_;

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
  const std::vector<const Medium*> expected{medium(2), medium(7), medium(5)};
  EXPECT_EQ(mediaAt(list_, 1.5), expected);
  expectSplits(list_, spans);
}

TEST_F(Segments, SpansWithoutLengthVanish) {
  const MediumSpan spans[] = {{1, 1, medium(0)}, {3, 2, medium(1)}};
  list_.assign(spans);
  EXPECT_THAT(list_.segments(), IsEmpty());
  const MediumSpan withOne[] = {spans[0], {0, 2, medium(5)}, spans[1]};
  list_.assign(withOne);
  for (const Segment& segment : list_.segments()) EXPECT_THAT(segment.media, ElementsAre(medium(5)));
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

/// 10^5 sets, half of them on a coarse grid so that many ends coincide: the segments cover the union and nothing else,
/// and through constant media the product over the segments is the product over the spans.
TEST_F(Segments, RandomSetsAreCoveredExactly) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 10), density(0, 0.3);
  std::vector<double> sigma(20);
  for (double& s : sigma) s = density(random);
  const auto first = medium(0);
  for (int round = 0; round < 100'000; ++round) {
    std::vector<MediumSpan> spans(random() % 9);
    double depth = 0;
    for (MediumSpan& span : spans) {
      const auto somewhere = [&] { return round % 2 == 0 ? place(random) : static_cast<double>(random() % 8); };
      const double a = somewhere(), b = somewhere();
      const std::size_t which = random() % sigma.size();
      span = {std::min(a, b), std::max(a, b), medium(which)};
      depth += sigma[which] * (span.t1 - span.t0);
    }
    list_.assign(spans);
    double found = 0, covered = 0, previous = -1;
    for (const Segment& segment : list_.segments()) {
      ASSERT_LT(segment.t0, segment.t1);
      ASSERT_GE(segment.t0, previous);
      previous = segment.t1;
      covered += segment.t1 - segment.t0;
      for (const Medium* each : segment.media)
        found += sigma[static_cast<std::size_t>(each - first)] * (segment.t1 - segment.t0);
    }
    std::vector<MediumSpan> order = sorted(spans);
    double covers = 0, reach = -1;
    for (const MediumSpan& span : order) {
      covers += std::max(0.0, span.t1 - std::max(reach, span.t0));
      reach = std::max(reach, span.t1);
    }
    ASSERT_NEAR(covered, covers, 1e-12) << round;
    ASSERT_NEAR(std::exp(-found), std::exp(-depth), 1e-12) << round;
  }
}

TEST_F(Segments, NothingIsAskedForBehindTheCurrentOne) {
  const MediumSpan spans[] = {{0, 4, medium(0)}, {1, 5, medium(1)}, {2, 6, medium(2)}, {9, 10, medium(3)}};
  KnownSpans source(spans);
  SegmentStream stream;
  stream.begin(source);
  Segment segment;
  ASSERT_TRUE(stream.next(segment));
  EXPECT_EQ(segment.t1, 1);
  EXPECT_EQ(source.taken(), 1u);
  ASSERT_TRUE(stream.next(segment));
  EXPECT_EQ(segment.t1, 2);
  EXPECT_EQ(source.taken(), 2u);
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

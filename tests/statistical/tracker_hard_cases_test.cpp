#include <gtest/gtest.h>

#include "core/volume/segment_stream.h"
#include "tests/statistical/tracker_cases.h"

// Where trackers break: segments without length, at the end of float's digits and without end; extinction from 0 to
// 1e12; emission without extinction; a million steps.

namespace aerosol::test {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// A segment and its media in which coefficients are what the test says, whatever the place.
class HardCase {
 public:
  HardCase(float t0, float t1, std::vector<Coefficients> media, float bound, float stepSize = 0.01f)
      : coefficients_(std::move(media)),
        evaluator_([this](const Medium& m, Point<World> p) {
          EXPECT_TRUE(std::isfinite(p.x)) << "a shader is asked at a point that is not finite";
          return coefficients_[m.index];
        }),
        media_(coefficients_.size()) {
    for (std::size_t i = 0; i < media_.size(); ++i) {
      media_[i].index = static_cast<std::uint32_t>(i);
      media_[i].bound = {bound, volume::Provenance::declared};
      media_[i].stepSize = stepSize;
      pointers_.push_back(&media_[i]);
    }
    segment_ = {t0, t1, pointers_};
    ray_.direction = {1, 0, 0};
  }
  HardCase(const HardCase&) = delete;
  HardCase& operator=(const HardCase&) = delete;

  Color throughput{1.0f};

  template <class Random>
  DistanceSample sample(Tracker tracker, Random& random) {
    for (std::size_t i = 0; i < media_.size(); ++i) {
      media_[i].constant.reset();
      if (tracker == Tracker::closedForm) media_[i].constant = coefficients_[i];
      prepare(tracker, media_[i]);
    }
    switch (tracker) {
      case Tracker::closedForm:
        return volume::sampleHomogeneous(segment_, throughput, random);
      case Tracker::marching:
        return evaluator_.finish(
            volume::sampleByMarching(evaluator_, ray_, segment_, media_[0].stepSize, throughput, random, table_));
      default:
        return sampleCollision(tracker, evaluator_, ray_, segment_, throughput, random);
    }
  }
  template <class Random>
  Color ratioTracking(Random& random) {
    return evaluator_.finish(volume::ratioTracking(evaluator_, ray_, span(), random));
  }
  template <class Random>
  Color marchedTransmittance(Random& random) {
    return evaluator_.finish(volume::marchedTransmittance(evaluator_, ray_, span(), media_[0].stepSize, random));
  }
  volume::MediumSpan span() const { return {segment_.t0, segment_.t1, &media_[0]}; }
  const volume::TrackerStatistics& statistics() { return evaluator_.trackerStatistics(); }
  std::uint64_t asked() const { return evaluator_.asked(); }

 private:
  std::vector<Coefficients> coefficients_;
  DensityEvaluator evaluator_;
  std::vector<Medium> media_;
  std::vector<const Medium*> pointers_;
  volume::Segment segment_;
  Ray<World> ray_;
  volume::MarchingTable table_;
};

void expectSound(const DistanceSample& s, const HardCase& c) {
  ASSERT_TRUE(isFinite(s.weight)) << s.weight.r << ' ' << s.weight.g << ' ' << s.weight.b;
  ASSERT_TRUE(isFinite(s.emission));
  ASSERT_GE(minimum(s.weight), 0);
  if (s.event != DistanceEvent::scattered) return;
  ASSERT_GE(s.t, c.span().t0);
  ASSERT_LE(s.t, c.span().t1);
  ASSERT_FALSE(std::isnan(s.logPdf));
}

class HardCases : public ::testing::TestWithParam<Tracker> {
 protected:
  Tracker tracker() const { return GetParam(); }
  DistanceSample sampleSoundly(HardCase& c) {
    const DistanceSample s = c.sample(tracker(), random_);
    expectSound(s, c);
    return s;
  }

  Uniforms random_{seedOfTest()};
};

INSTANTIATE_TEST_SUITE_P(All, HardCases, ::testing::ValuesIn(allTrackers),
                         [](const auto& info) { return std::string(name(info.param)); });

TEST_P(HardCases, SegmentOfZeroLength) {
  for (const float t : {0.0f, 3.0f, 1e6f}) {
    HardCase c(t, t, {coefficients(Color(5.0f), Color(0.9f), Color(7.0f))}, 5);
    for (int i = 0; i < 1000; ++i) {
      const DistanceSample s = sampleSoundly(c);
      if (s.event == DistanceEvent::passed) ASSERT_EQ(s.weight, Color(1.0f));
      ASSERT_EQ(s.emission, Color());
    }
  }
}

/// One ulp far out: flights are much shorter or much longer than the last digit of t.
TEST_P(HardCases, SegmentOfOneUlpFarOut) {
  const float t0 = 1e6f, t1 = std::nextafter(t0, infinity);
  const double length = static_cast<double>(t1) - static_cast<double>(t0);
  for (const float sigma : {1e-6f, 1.0f, 20.0f, 1e6f}) {
    HardCase c(t0, t1, {coefficients(Color(sigma), Color(1.0f))}, sigma, 0.001f);
    RunningMean passed;
    for (int i = 0; i < 20000; ++i) {
      const DistanceSample s = sampleSoundly(c);
      passed.add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight.g) : 0);
    }
    const double expected = std::exp(-static_cast<double>(sigma) * length);
    EXPECT_NEAR(passed.mean(), expected, 4 * passed.standardError() + 1e-5);
  }
}

/// Flights a tenth of the last digit of t: their sum is right all the same.
TEST(TrackersFarOut, FlightsShorterThanTheLastDigitAddUp) {
  const float t0 = 1e6f, t1 = t0 + 1;  // 16 ulps
  const Coefficients thin = coefficients(Color(1.0f), Color(1.0f));
  HardCase underALooseBound(t0, t1, {thin}, 160);
  Uniforms random(seedOfTest());
  RunningMean passed, ratio;
  for (int i = 0; i < 50000; ++i) {
    const DistanceSample s = underALooseBound.sample(Tracker::nullScattering, random);
    passed.add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight.g) : 0);
    ratio.add(static_cast<double>(underALooseBound.ratioTracking(random).g));
  }
  EXPECT_TRUE(agrees(passed, std::exp(-1), 0.01));
  EXPECT_TRUE(agrees(ratio, std::exp(-1)));
}

/// One span that is given once.
class OneSpan final : public volume::SpanSource {
 public:
  explicit OneSpan(const volume::MediumSpan& span) : span_(span) {}
  const volume::MediumSpan* peek(double limit) override { return !isTaken_ && span_.t0 < limit ? &span_ : nullptr; }
  void pop() override { isTaken_ = true; }

 private:
  volume::MediumSpan span_;
  bool isTaken_ = false;
};

TEST_P(HardCases, SegmentThatBeginsAndEndsAtInfinityHasNoLength) {
  // Such spans are dropped; there is no segment to sample.
  const Medium medium;
  OneSpan source({infinity, infinity, &medium});
  volume::SegmentStream stream;
  stream.begin(source);
  volume::Segment segment;
  EXPECT_FALSE(stream.next(segment));
}

TEST_P(HardCases, InfiniteFog) {
  const Color albedo(0.9f, 0.5f, 0.2f), emission(0.1f, 0.2f, 0.3f);
  const Color sigma(0.2f, 0.5f, 0.8f);
  HardCase c(1, infinity, {coefficients(sigma, albedo, emission)}, 0.8f, 0.25f);
  std::array<RunningMean, 3> scattered, emitted;
  for (int i = 0; i < 200000; ++i) {
    const DistanceSample s = sampleSoundly(c);
    ASSERT_NE(s.event, DistanceEvent::passed);
    for (const int k : channels) {
      scattered[static_cast<std::size_t>(k)].add(static_cast<double>(s.weight[k]));
      emitted[static_cast<std::size_t>(k)].add(static_cast<double>(s.emission[k]));
    }
  }
  for (const int k : channels) {
    const auto i = static_cast<std::size_t>(k);
    EXPECT_NEAR(scattered[i].mean(), static_cast<double>(albedo[k]), 4 * scattered[i].standardError() + 1e-5);
    const double glow = static_cast<double>(emission[k]) / static_cast<double>(sigma[k]);
    EXPECT_NEAR(emitted[i].mean(), glow, 4 * emitted[i].standardError() + 2e-3 * glow);
  }
}

TEST_P(HardCases, InfiniteFogThatLetsOneChannelThrough) {
  HardCase c(0, infinity, {coefficients(Color(0, 1, 2), Color(0.9f))}, 2, 0.5f);
  c.throughput = Color(0, 1, 1);  // A red that is left would go on for ever: so does its ray.
  for (int i = 0; i < 20000; ++i) {
    const DistanceSample s = sampleSoundly(c);
    ASSERT_NE(s.event, DistanceEvent::passed);
    if (tracker() != Tracker::analogue) ASSERT_EQ(s.event, DistanceEvent::scattered);
  }
}

TEST(ClosedFormHardCases, InfiniteEmptiness) {
  for (const Color sigma : {Color(), Color(0, 1, 2)}) {
    HardCase c(0, infinity, {coefficients(sigma, Color(0.9f))}, 2);
    Uniforms random(seedOfTest());
    RunningMean red;
    for (int i = 0; i < 20000; ++i) {
      const DistanceSample s = c.sample(Tracker::closedForm, random);
      expectSound(s, c);
      red.add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight.r) : 0);
    }
    EXPECT_NEAR(red.mean(), 1, 4 * red.standardError() + 1e-6);
  }
}

TEST(MarchingHardCases, InfiniteEmptinessEndsAndIsCounted) {
  HardCase c(0, infinity, {coefficients(Color(), Color(0.9f))}, 1, 0.5f);
  Uniforms random(seedOfTest());
  EXPECT_EQ(c.sample(Tracker::marching, random).event, DistanceEvent::passed);
  EXPECT_EQ(c.marchedTransmittance(random), Color(1.0f));
  EXPECT_EQ(c.statistics().stepLimits, 2u);
  EXPECT_LE(c.asked(), 2u * volume::maximumSteps);
}

TEST_P(HardCases, ExtinctionFromNothingToEverything) {
  for (const float sigma : {0.0f, 1e-45f, 1e-40f, 1e-38f, 1e-30f, 1e-12f, 1e-3f, 1e3f, 1e12f, 1e30f}) {
    HardCase c(0.5f, 1.5f, {coefficients(Color(sigma), Color(0.75f), Color(sigma))}, sigma);
    RunningMean passed, scattered, emission;
    for (int i = 0; i < 2000; ++i) {
      const DistanceSample s = sampleSoundly(c);
      passed.add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight.g) : 0);
      scattered.add(s.event == DistanceEvent::scattered ? static_cast<double>(s.weight.g) : 0);
      emission.add(static_cast<double>(s.emission.g));
    }
    // A rare event may not occur at all: its deviation is known, that of the samples says nothing then.
    const double transmittance = std::exp(-static_cast<double>(sigma)), lost = -std::expm1(-static_cast<double>(sigma));
    const double slack = 4 * std::sqrt(transmittance * lost / 2000) + 1e-4;
    EXPECT_NEAR(passed.mean(), transmittance, 4 * passed.standardError() + slack) << sigma;
    EXPECT_NEAR(scattered.mean(), 0.75 * lost, 4 * scattered.standardError() + slack) << sigma;
    EXPECT_NEAR(emission.mean(), lost, 4 * emission.standardError() + slack) << sigma;
    EXPECT_EQ(c.statistics().stepLimits, 0u);
  }
}

/// A distance in a medium of denormal extinction, found because the segment is long: 1 / σ does not fit into a float.
TEST_P(HardCases, DenormalExtinctionOverAnEndlessSegment) {
  constexpr float longest = std::numeric_limits<float>::max();
  for (const float end : {longest, infinity}) {
    // Looking once a step, trackers that step never end in an infinite segment.
    if (end == infinity && tracker() != Tracker::closedForm) continue;
    for (const float sigma : {1e-45f, 1e-40f, 1e-38f, 1e-30f}) {
      HardCase c(0, end, {coefficients(Color(sigma), Color(0.75f))}, sigma, longest / 10);
      for (int i = 0; i < 1000; ++i) sampleSoundly(c);
    }
  }
}

TEST_P(HardCases, NothingInOneChannelAndEverythingInAnother) {
  const Color sigma(0, 1, 1e12f), albedo(1, 0.5f, 0.9f);
  HardCase c(0, 1, {coefficients(sigma, albedo)}, 1e12f, 0.001f);
  if (tracker() != Tracker::closedForm && tracker() != Tracker::marching) {
    // A bound of 1e12 for a channel that needs one of 1: given up after millions of collisions, counted.
    c.throughput = Color(0, 0, 1);
  }
  std::array<RunningMean, 3> passed, scattered;
  for (int i = 0; i < 50000; ++i) {
    const DistanceSample s = sampleSoundly(c);
    for (const int k : channels) {
      passed[static_cast<std::size_t>(k)].add(s.event == DistanceEvent::passed ? static_cast<double>(s.weight[k]) : 0);
      scattered[static_cast<std::size_t>(k)].add(s.event == DistanceEvent::scattered ? static_cast<double>(s.weight[k])
                                                                                     : 0);
    }
  }
  for (const int k : channels) {
    if (c.throughput[k] == 0) continue;
    const auto i = static_cast<std::size_t>(k);
    const double transmittance = std::exp(-static_cast<double>(sigma[k]));
    EXPECT_NEAR(passed[i].mean(), transmittance, 4 * passed[i].standardError() + 1e-5) << k;
    EXPECT_NEAR(scattered[i].mean(), static_cast<double>(albedo[k]) * (1 - transmittance),
                4 * scattered[i].standardError() + 1e-5)
        << k;
  }
}

TEST_P(HardCases, OpticalDepthOfAMillion) {
  HardCase c(0, 1, {coefficients(Color(1e6f), Color(1.0f))}, 1.5e6f, 0.001f);
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(sampleSoundly(c).event, DistanceEvent::scattered);
  Uniforms random(seedOfTest(1));
  for (int i = 0; i < 100; ++i) {
    ASSERT_LT(c.ratioTracking(random).g, 1e-6f);
    ASSERT_EQ(c.marchedTransmittance(random), Color());
  }
}

TEST_P(HardCases, EmissionWithoutExtinction) {
  for (const float sigma : {0.0f, 1e-30f, 1e-7f}) {
    HardCase c(1, 3, {coefficients(Color(sigma), Color(0.5f), Color(1, 2, 3))}, 2, 0.1f);
    std::array<RunningMean, 3> emission;
    for (int i = 0; i < 30000; ++i) {
      const DistanceSample s = sampleSoundly(c);
      for (const int k : channels) emission[static_cast<std::size_t>(k)].add(static_cast<double>(s.emission[k]));
    }
    for (const int k : channels) {
      const auto i = static_cast<std::size_t>(k);
      EXPECT_NEAR(emission[i].mean(), 2.0 * (k + 1), 4 * emission[i].standardError() + 1e-5 * (k + 1)) << sigma;
      EXPECT_LE(emission[i].standardError(), 0.01 * (k + 1));
    }
  }
}

/// A medium that only glows, under the bound 0 that it rightly declares.
TEST_P(HardCases, EmissionUnderABoundOfZero) {
  HardCase c(1, 3, {coefficients(Color(), Color(), Color(1.0f))}, 0, 0.1f);
  RunningMean emission;
  for (int i = 0; i < 20000; ++i) emission.add(static_cast<double>(sampleSoundly(c).emission.g));
  EXPECT_NEAR(emission.mean(), 2, 4 * emission.standardError() + 1e-5);
  EXPECT_LE(emission.standardError(), 0.01);
}

/// The last number below 1, and 0, in every place where a random number is used.
TEST_P(HardCases, EndsOfRandomNumbers) {
  struct Extremes {
    unsigned bits = 0;
    int calls = 0;
    float next() {
      if (calls++ >= 8) return 0.4f;
      const float u = (bits & 1) != 0 ? 0x1.fffffep-1f : 0.0f;
      bits >>= 1;
      return u;
    }
  };
  for (const Color sigma : {Color(2.0f), Color(0, 1, 2), Color(1, 0, 0), Color(0, 0, 1)}) {
    for (const Color throughput : {Color(1.0f), Color(0, 0, 1), Color(1, 0, 0), Color(), Color(infinity)}) {
      HardCase c(0, 1, {coefficients(sigma, Color(0.5f))}, 2);
      c.throughput = throughput;
      for (unsigned bits = 0; bits < 256; ++bits) {
        Extremes random{bits};
        expectSound(c.sample(tracker(), random), c);
      }
    }
  }
}

/// A million cells: the sum keeps its digits.
TEST(MarchingHardCases, AMillionStepsKeepTheirDigits) {
  for (const float sigma : {0.1f, 1.0f, 7.77f}) {
    HardCase c(0, 1, {coefficients(Color(sigma), Color(1.0f))}, sigma, 1e-6f);
    Uniforms random(seedOfTest());
    const double depth = -std::log(static_cast<double>(c.marchedTransmittance(random).g));
    EXPECT_NEAR(depth, static_cast<double>(sigma), 1e-5 * static_cast<double>(sigma));
    EXPECT_GE(c.asked(), 999999u);
  }
}

TEST(NullScatteringHardCases, AMillionCollisionsKeepTheirDigits) {
  // Nothing but null collisions: the flights alone.
  HardCase c(0, 1, {coefficients(Color(), Color())}, 1e6f);
  Uniforms random(seedOfTest());
  const DistanceSample s = c.sample(Tracker::nullScattering, random);
  EXPECT_EQ(s.event, DistanceEvent::passed);
  EXPECT_EQ(s.weight, Color(1.0f));
  EXPECT_NEAR(static_cast<double>(c.asked()), 1e6, 5e3);
  // ∏ μ̄ e^(-μ̄ d): the logarithm of the rate of every collision and the whole exponent.
  const double expected = static_cast<double>(c.asked()) * std::log(1e6) - 1e6;
  EXPECT_NEAR(s.logPdf, expected, 1e-6 * std::fabs(expected));
}

TEST(NullScatteringHardCases, EndlessCollisionsAreGivenUpAndCounted) {
  HardCase c(0, 1, {coefficients(Color(), Color())}, 1e12f);
  Uniforms random(seedOfTest());
  EXPECT_EQ(c.sample(Tracker::nullScattering, random).event, DistanceEvent::passed);
  EXPECT_EQ(c.ratioTracking(random), Color(1.0f));
  EXPECT_EQ(c.statistics().stepLimits, 2u);
  EXPECT_EQ(c.asked(), 2u * volume::maximumSteps);
}

}  // namespace
}  // namespace aerosol::test

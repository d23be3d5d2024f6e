#include "core/volume/equiangular.h"

#include <gtest/gtest.h>

#include "tests/statistical/statistics.h"

// Equiangular sampling from D = 0 to 1e7, the light in front, behind, beside and at the ends of the ray's stretches:
// samples follow the density, which integrates to one, against long double throughout.

namespace aerosol::test {
namespace {

using volume::EquiangularSampler;
using volume::EquiangularStretch;
using volume::RayStretches;

constexpr double infinity = std::numeric_limits<double>::infinity();

struct StretchCase {
  double distance, a, b;
  friend std::ostream& operator<<(std::ostream& out, const StretchCase& c) {
    return out << "D " << c.distance << " from " << c.a << " to " << c.b;
  }
};

/// θ(t) = atan(t / D) from a to t, in long double; on the ray 1/a - 1/t.
long double part(const StretchCase& c, double t) {
  const auto d = static_cast<long double>(c.distance), a = static_cast<long double>(c.a),
             x = static_cast<long double>(t);
  if (c.distance == 0) return std::isinf(t) ? 1 / a : (x - a) / (a * x);
  // The angle between the two ends without the cancellation of two angles near a right one.
  if (std::isinf(t)) return std::atan2(d, a) / d;
  return std::atan2(d * (x - a), d * d + a * x) / d;
}

std::vector<StretchCase> stretchCases() {
  std::vector<StretchCase> cases;
  for (const double d : {1e-30, 1e-7, 1e-3, 1.0, 1e3, 1e7}) {
    for (const auto& [a, b] : {std::pair{1.0, 3.0},
                               {-3.0, -1.0},
                               {-2.0, 1.0},
                               {0.0, 2.0},
                               {-2.0, 0.0},
                               {1e-9, 1e3},
                               {1e6, 1e6 + 1e-3},
                               {5.0, infinity},
                               {-5.0, infinity},
                               {-1e-6, 1e-6}}) {
      cases.push_back({d, a, b});
    }
  }
  for (const auto& [a, b] : {std::pair{1.0, 3.0}, {-3.0, -1.0}, {1e-9, 1e3}, {5.0, infinity}, {1e6, 1e6 + 1e-3}}) {
    cases.push_back({0, a, b});
  }
  return cases;
}

class Equiangular : public ::testing::TestWithParam<StretchCase> {};

/// The part of the density up to the sample for ξ is ξ. A place has 53 bits: where the density is so high that its
/// last bit matters, ξ is met up to that.
TEST_P(Equiangular, SamplesInvertTheDistribution) {
  const StretchCase& c = GetParam();
  const EquiangularStretch stretch(c.distance, c.a, c.b);
  const long double whole = part(c, c.b);
  EXPECT_NEAR(stretch.integral / static_cast<double>(whole), 1, 1e-12);
  for (int i = 0; i <= 64; ++i) {
    const double xi = i == 64 ? 1 - 0x1p-24 : i / 64.0;
    const double t = stretch.sample(xi);
    ASSERT_TRUE(std::isfinite(t));
    ASSERT_GE(t, c.a);
    ASSERT_LE(t, c.b);
    const double pdf = stretch.pdf(t);
    ASSERT_TRUE(std::isfinite(pdf)) << t;
    ASSERT_GT(pdf, 0);
    const double found = static_cast<double>(part(c, t) / whole);
    const double lastBit = pdf * std::max(std::fabs(t), std::isfinite(c.b) ? std::fabs(c.a) : 0) * 0x1p-50;
    ASSERT_NEAR(found, xi, 1e-9 + lastBit) << "t " << t;
  }
}

TEST_P(Equiangular, DensityIsTheFalloff) {
  const StretchCase& c = GetParam();
  const EquiangularStretch stretch(c.distance, c.a, c.b);
  for (const double xi : {0.1, 0.5, 0.9}) {
    const double t = stretch.sample(xi), pdf = stretch.pdf(t);
    EXPECT_NEAR(pdf * stretch.integral * (c.distance * c.distance + t * t), 1, 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Equiangular, ::testing::ValuesIn(stretchCases()),
                         [](const auto& info) { return "number" + std::to_string(info.index); });

/// Several stretches with gaps, the light beside each of them in turn.
TEST(EquiangularSamplerTest, SamplesFollowTheDensityOverStretches) {
  RayStretches stretches;
  stretches.add(0.5, 1);
  stretches.add(1, 2);
  stretches.add(3, 3.5);
  stretches.add(5, infinity);
  ASSERT_EQ(stretches.all().size(), 3u);
  constexpr int bins = 60, samples = 200000;
  for (const double projection : {-1.0, 1.2, 2.5, 3.25, 20.0}) {
    const EquiangularSampler sampler(stretches, projection, 0.3);
    Uniforms random(seedOfTest(static_cast<std::uint64_t>(projection + 10)));
    std::vector<double> observed(bins + 1), expected(bins + 1);
    for (int i = 0; i < samples; ++i) {
      const double t = sampler.sample(static_cast<double>(random.next()));
      ASSERT_GT(sampler.pdf(t), 0);
      ++observed[std::min(static_cast<std::size_t>(t * 5), static_cast<std::size_t>(bins))];
    }
    double total = 0;
    for (int b = 0; b < bins; ++b) {
      const double mass = integrate([&](double t) { return sampler.pdf(t); }, b / 5.0, (b + 1) / 5.0, 200);
      expected[static_cast<std::size_t>(b)] = samples * mass;
      total += mass;
    }
    expected[bins] = samples * (1 - total);
    EXPECT_GT(1 - total, -1e-3);
    EXPECT_TRUE(countsAgree(observed, expected)) << projection;
    EXPECT_EQ(sampler.pdf(2.5), 0);
    EXPECT_EQ(sampler.pdf(0.25), 0);
  }
}

/// The tail behind 12 is known in closed form, so that nothing of the density is missing.
TEST(EquiangularSamplerTest, DensityIntegratesToOne) {
  RayStretches stretches;
  stretches.add(0.5, 2);
  stretches.add(3, 12);
  for (const double projection : {-4.0, 1.0, 2.5, 11.0}) {
    for (const double distance : {0.01, 0.3, 40.0}) {
      const EquiangularSampler sampler(stretches, projection, distance);
      double total = 0;
      for (const auto& [a, b] : {std::pair{0.5, 2.0}, {3.0, 12.0}}) {
        total += integrate([&](double t) { return sampler.pdf(t); }, a, b, 20000);
      }
      EXPECT_NEAR(total, 1, 1e-6) << projection << ' ' << distance;
    }
  }
}

TEST(EquiangularSamplerTest, APlantedErrorOfTwoPercentIsCaught) {
  RayStretches stretches;
  stretches.add(0, 2);
  const EquiangularSampler sampler(stretches, 0.7, 0.3), wrong(stretches, 0.7, 0.306);
  Uniforms random(seedOfTest());
  std::vector<double> observed(20), expected;
  constexpr int samples = 400000;
  for (int i = 0; i < samples; ++i) {
    ++observed[static_cast<std::size_t>(wrong.sample(static_cast<double>(random.next())) * 10)];
  }
  for (int b = 0; b < 20; ++b) {
    expected.push_back(samples * integrate([&](double t) { return sampler.pdf(t); }, b / 10.0, (b + 1) / 10.0, 50));
  }
  EXPECT_FALSE(countsAgree(observed, expected));
}

/// More stretches than there is room for become one; nothing of them is lost.
TEST(RayStretchesTest, TheLastOnesTakeInWhatHasNoRoom) {
  RayStretches stretches;
  for (int i = 0; i < 10; ++i) stretches.add(i, i + 0.5);
  ASSERT_EQ(stretches.all().size(), RayStretches::room);
  EXPECT_EQ(stretches.begin(), 0);
  EXPECT_EQ(stretches.end(), 9.5);
  const EquiangularSampler sampler(stretches, 4, 1);
  for (int i = 0; i < 10; ++i) EXPECT_GT(sampler.pdf(i + 0.25), 0);
}

/// Constant media one behind the other, a gap between them: the light that is left is part of the density.
TEST(AttenuatedEquiangular, SamplesFollowTheDensityAndThatTheIntegrand) {
  const std::array<std::array<double, 2>, 2> ends{{{0.5, 2}, {2.5, 4}}};
  const std::array<volume::RayExtinction, 2> extinctions{
      {{Color(0.4f, 0.8f, 1.6f), Color(0.3f, 0.6f, 1.2f)}, {Color(2.0f), Color(1.5f)}}};
  RayStretches stretches;
  for (std::size_t i = 0; i < 2; ++i) stretches.add(ends[i][0], ends[i][1], extinctions[i]);
  ASSERT_TRUE(stretches.isKnown());
  ASSERT_EQ(stretches.all().size(), 2u);
  /// σs T, averaged over channels.
  const auto left = [&](double t) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      double depth = 0, scattering = 0;
      for (std::size_t i = 0; i < 2; ++i) {
        const auto sigma = static_cast<double>(extinctions[i].sigmaT[c]);
        depth += sigma * std::clamp(t - ends[i][0], 0.0, ends[i][1] - ends[i][0]);
        if (t >= ends[i][0] && t <= ends[i][1]) scattering = static_cast<double>(extinctions[i].sigmaS[c]);
      }
      sum += scattering * std::exp(-depth) / 3;
    }
    return sum;
  };
  constexpr int bins = 70, samples = 200000;
  for (const auto& [projection, distance] :
       {std::pair{-1.0, 0.3}, {1.2, 0.02}, {2.25, 0.5}, {3.0, 1e-3}, {20.0, 5.0}, {4.5, 0.0}}) {
    const volume::AttenuatedEquiangularSampler sampler(stretches, projection, distance);
    const auto integrand = [&](double t) {
      return left(t) / (distance * distance + (t - projection) * (t - projection));
    };
    const double whole = integrate(integrand, 0.5, 2, 4000) + integrate(integrand, 2.5, 4, 4000);
    EXPECT_NEAR(sampler.integral() / whole, 1, 0.25) << projection;
    Uniforms random(seedOfTest(static_cast<std::uint64_t>(projection * 10 + 100)));
    std::vector<double> observed(bins + 1), expected(bins + 1);
    double worst = 0;
    RunningMean estimate;
    for (int i = 0; i < samples; ++i) {
      const double t = sampler.sample(static_cast<double>(random.next()));
      const double pdf = sampler.pdf(t);
      ASSERT_GT(pdf, 0) << t;
      ++observed[std::min(static_cast<std::size_t>(t * 20 - 10), static_cast<std::size_t>(bins))];
      worst = std::max(worst, integrand(t) / pdf / whole);
      estimate.add(integrand(t) / pdf);
    }
    EXPECT_TRUE(agrees(estimate, whole)) << projection;
    EXPECT_LT(worst, 2.5) << projection;
    for (int b = 0; b < bins; ++b) {
      expected[static_cast<std::size_t>(b)] =
          samples * integrate([&](double t) { return sampler.pdf(t); }, 0.5 + b / 20.0, 0.5 + (b + 1) / 20.0, 2000);
    }
    EXPECT_TRUE(countsAgree(observed, expected)) << projection;
  }
}

/// What is not known of the way turns the attenuation off.
TEST(AttenuatedEquiangular, NeedsToKnowTheWholeWay) {
  const volume::RayExtinction fog{Color(1.0f), Color(0.5f)};
  RayStretches overlapping;
  overlapping.add(0, 2, fog);
  overlapping.add(1, 3, fog);
  EXPECT_FALSE(overlapping.isKnown());
  EXPECT_EQ(overlapping.all().size(), 1u);
  RayStretches varying;
  varying.add(0, 1, fog);
  varying.add(1, 2);
  EXPECT_FALSE(varying.isKnown());
  varying.add(3, 4, fog);
  EXPECT_FALSE(varying.isKnown());
  RayStretches endless;
  endless.add(0, infinity, fog);
  EXPECT_FALSE(endless.isKnown());
}

}  // namespace
}  // namespace aerosol::test

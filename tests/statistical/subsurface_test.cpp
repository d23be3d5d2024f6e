#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/render/subsurface_walk.h"
#include "core/render/warp.h"
#include "tests/statistical/statistics.h"

// Walks through bodies against half-spaces in closed form and slabs by a plain walk in one dimension.

namespace aerosol::render {
namespace {

using test::agrees;
using test::RunningMean;
using test::seedOfTest;
using test::Uniforms;

/// What half a space reflects of even light, 1 - 2 sqrt(1 - α) ∫ H(μ) μ dμ, with Chandrasekhar's H function by
/// iteration of 1 / H(μ) = sqrt(1 - α) + α/2 ∫ μ' H(μ') / (μ + μ') dμ' at midpoints.
double halfSpaceAlbedo(double alpha) {
  constexpr int count = 400;
  const double root = std::sqrt(1 - alpha);
  std::vector<double> h(count, 1.0);
  const auto node = [](int i) { return (i + 0.5) / count; };
  for (int iteration = 0; iteration < 200; ++iteration) {
    std::vector<double> next(count);
    for (int i = 0; i < count; ++i) {
      double sum = 0;
      for (int j = 0; j < count; ++j) sum += node(j) * h[static_cast<std::size_t>(j)] / (node(i) + node(j)) / count;
      next[static_cast<std::size_t>(i)] = 1 / (root + 0.5 * alpha * sum);
    }
    h = std::move(next);
  }
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += node(i) * h[static_cast<std::size_t>(i)] / count;
  return 1 - 2 * root * sum;
}

TEST(SubsurfaceBody, HasTheAlbedoThatReflectsTheColour) {
  for (const float reflected : {0.05f, 0.3f, 0.6f, 0.9f, 0.99f}) {
    const SubsurfaceBody body = bodyThatReflects(Color(reflected), Color(2), 0);
    EXPECT_NEAR(halfSpaceAlbedo(static_cast<double>(body.albedo.r)), static_cast<double>(reflected), 0.003);
    EXPECT_FLOAT_EQ(body.extinction.r, 0.5f);
  }
  EXPECT_EQ(bodyThatReflects(Color(1), Color(1), 0.5f).albedo, Color(1));
  EXPECT_NEAR(bodyThatReflects(Color(0), Color(1), 0.5f).albedo.r, 0, 1e-4);
  // By similarity: what counts is (1 - α) / (1 - g α).
  const auto s = [](float g) {
    const float alpha = bodyThatReflects(Color(0.5f), Color(1), g).albedo.r;
    return (1 - alpha) / (1 - g * alpha);
  };
  EXPECT_NEAR(s(0.7f), s(0), 1e-5);
  EXPECT_NEAR(s(-0.7f), s(0), 1e-5);
}

/// A box from z = -thickness to 0, so wide that no walk sees its sides; object 1. Object 0 lies inside of it.
accel::Scene slab(float thickness) {
  accel::SceneBuilder builder;
  const Matrix4 inner{{{0.1, 0, 0, 0}, {0, 0.1, 0, 0}, {0, 0, 0.1, -0.3}, {0, 0, 0, 1}}};
  const Matrix4 outer{{{1e4, 0, 0, 0},
                       {0, 1e4, 0, 0},
                       {0, 0, 0.5 * static_cast<double>(thickness), -0.5 * static_cast<double>(thickness)},
                       {0, 0, 0, 1}}};
  const auto place = [](const Matrix4& m) {
    Matrix4 inverse;
    EXPECT_TRUE(invert(m, inverse));
    return Transform<World, Object>(m, inverse);
  };
  EXPECT_TRUE(builder.addSphere(place(inner)));
  EXPECT_TRUE(builder.addMesh(accel::makeCube(place(outer))));
  auto scene = builder.build();
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

struct Shares {
  RunningMean reflected[3], transmitted[3];
};

/// What comes out above and below of even light from above.
Shares walk(const SubsurfaceBody& body, float thickness, int count, std::uint64_t seed) {
  const accel::Scene scene = slab(thickness);
  accel::Counters counters;
  accel::SpanBuffer spans;
  Ray<World> down;
  down.origin = {0.1f, 0.2f, 5};
  down.direction = {0, 0, -1};
  const auto hit = scene.closestHit(down, spans, counters);
  Shares shares;
  if (!hit || hit->object != 1) {
    ADD_FAILURE() << "missed";
    return shares;
  }
  Uniforms uniforms(seed);
  for (int i = 0; i < count; ++i) {
    SampleStream random(SamplerKind::independent, seed, 1, 2, static_cast<std::uint32_t>(i));
    const auto d = toCosineHemisphere(uniforms.next2D());
    const Vector<World> direction =
        normalize(Vector<World>(static_cast<float>(d[0]), static_cast<float>(d[1]), -static_cast<float>(d[2])));
    const auto way = walkThroughBody(scene, {body, *hit, direction, 0}, random, counters);
    const bool isAbove = way && way->hit.point.z > -0.5f * thickness;
    for (int c = 0; c < 3; ++c) {
      const double weight = way ? static_cast<double>(way->weight[c]) : 0;
      shares.reflected[c].add(isAbove ? weight : 0);
      shares.transmitted[c].add(way && !isAbove ? weight : 0);
    }
  }
  return shares;
}

TEST(SubsurfaceWalk, ReflectsAsHalfASpaceDoes) {
  const SubsurfaceBody body{.albedo = {0.99f, 0.9f, 0.5f}, .extinction = {20, 30, 50}};
  const Shares shares = walk(body, 100, 120000, seedOfTest());
  for (int c = 0; c < 3; ++c) {
    EXPECT_TRUE(agrees(shares.reflected[c], halfSpaceAlbedo(static_cast<double>(body.albedo[c])), 0.006)) << c;
  }
}

/// The guide is there to make noise less: an analogue walk that ends with 0 or 1 has the variance A (1 - A).
TEST(SubsurfaceWalk, IsLessNoisyThanAnAnalogueOne) {
  for (const float albedo : {0.8f, 0.95f}) {
    const SubsurfaceBody body{.albedo = Color(albedo), .extinction = Color(30)};
    const double expected = halfSpaceAlbedo(static_cast<double>(albedo));
    const Shares shares = walk(body, 100, 20000, seedOfTest());
    EXPECT_LT(shares.reflected[0].variance(), 0.5 * expected * (1 - expected)) << albedo;
  }
}

/// A plain walk between two planes, in double, with the angle to the planes alone: one channel.
std::array<RunningMean, 2> plainWalk(double albedo, double extinction, double g, double thickness, int count,
                                     std::uint64_t seed) {
  std::array<RunningMean, 2> shares;
  Uniforms random(seed);
  const auto next = [&] { return static_cast<double>(random.next()); };
  for (int i = 0; i < count; ++i) {
    double z = 0, mu = -std::sqrt(next()), weight = 1;
    while (true) {
      z += mu * -std::log1p(-next()) / extinction;
      if (z > 0 || z < -thickness) break;
      weight *= albedo;
      if (weight < 1e-4) break;
      const double u = next();
      const double f = g == 0 ? 0 : (1 - g * g) / (1 + g - 2 * g * u);
      const double cosine = g == 0 ? 1 - 2 * u : (1 + g * g - f * f) / (2 * g);
      const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
      mu = mu * cosine + std::sqrt(std::max(0.0, 1 - mu * mu)) * sine * std::cos(2 * std::numbers::pi * next());
      mu = std::clamp(mu, -1.0, 1.0);
    }
    shares[0].add(z > 0 ? weight : 0);
    shares[1].add(z < -thickness ? weight : 0);
  }
  return shares;
}

TEST(SubsurfaceWalk, PassesSlabsAsAPlainWalkDoes) {
  std::uint64_t setting = 0;
  for (const float g : {0.0f, 0.7f, -0.5f}) {
    for (const float thickness : {0.2f, 2.0f}) {
      const SubsurfaceBody body{.albedo = {0.95f, 0.6f, 0.2f}, .extinction = {1, 2, 3}, .anisotropy = g};
      const Shares found = walk(body, thickness, 60000, seedOfTest(setting++));
      for (int c = 0; c < 3; ++c) {
        const auto plain =
            plainWalk(static_cast<double>(body.albedo[c]), static_cast<double>(body.extinction[c]),
                      static_cast<double>(g), static_cast<double>(thickness), 200000, seedOfTest(setting++));
        for (const auto& [a, b] :
             {std::pair(found.reflected[c], plain[0]), std::pair(found.transmitted[c], plain[1])}) {
          const double error = std::hypot(a.standardError(), b.standardError());
          EXPECT_LE(std::fabs(a.mean() - b.mean()), 4 * error)
              << g << ' ' << thickness << ' ' << c << ": " << a.mean() << " of " << b.mean() << " ± " << error;
          EXPECT_LE(error, std::max(0.02 * b.mean(), 2e-3)) << "resolves nothing";
        }
      }
    }
  }
}

/// A reflecting boundary keeps walks inside; nothing is lost where nothing is absorbed.
TEST(SubsurfaceWalk, LosesNothingBelowADielectric) {
  const SubsurfaceBody body{.albedo = Color(1), .extinction = Color(2, 3, 4), .ior = 1.5f};
  const Shares shares = walk(body, 1, 30000, seedOfTest());
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(shares.reflected[c].mean() + shares.transmitted[c].mean(), 1, 0.01) << c;
  }
  EXPECT_NEAR(evenTransmittance(1.5f), 1 - 0.0918, 5e-4);
  EXPECT_NEAR(evenTransmittance(1), 1, 1e-6);
}

TEST(SubsurfaceExit, SumsUpToOne) {
  const accel::Scene scene = slab(1);
  accel::Counters counters;
  Ray<World> up;
  up.origin = {0.1f, 0.2f, -0.9f};
  up.direction = normalize(Vector<World>(0.3f, 0.1f, 1));
  const auto hit = scene.closestHitOn(1, up, counters);
  ASSERT_TRUE(hit && !hit->entering);
  for (const float ior : {0.0f, 1.3f, 1.8f}) {
    const BodyExit exit({.ior = ior}, *hit);
    Uniforms random(seedOfTest());
    RunningMean weights;
    for (int i = 0; i < 100000; ++i) {
      const auto s = exit.mix().sample({0, random.next2D()});
      ASSERT_TRUE(s && s->direction.z > 0);
      EXPECT_NEAR(s->pdf, exit.mix().pdf(s->direction), 1e-5f);
      weights.add(static_cast<double>(s->weight.g));
    }
    EXPECT_NEAR(weights.mean(), 1, std::max(1e-6, 4 * weights.standardError())) << ior;
    EXPECT_TRUE(isBlack(exit.mix().evaluate({0, 0, -1})));
  }
}

}  // namespace
}  // namespace aerosol::render

#include "core/render/light_tree.h"

#include <gtest/gtest.h>

#include "core/accel/scene.h"
#include "core/render/lights_along_ray.h"
#include "core/render/registry.h"
#include "plugins/registration.h"
#include "tests/statistical/statistics.h"

// The hierarchy of lights: chosen as its probabilities say, from points and from rays; none forgotten that can be seen.

namespace aerosol::render {
namespace {

using test::agrees;
using test::countsAgree;
using test::RunningMean;
using test::seedOfTest;
using test::Uniforms;

/// Lights all over a cube, in clusters, of very different strength; some with a normal, some in the same place.
std::vector<LightBounds> manyLights(int count, std::uint64_t seed) {
  Uniforms random(seed);
  std::vector<LightBounds> lights;
  for (int i = 0; i < count; ++i) {
    LightBounds light;
    const float cluster = i % 3 == 0 ? 0.05f : 1.0f;
    const Point<World> p(cluster * (2 * random.next() - 1), cluster * (2 * random.next() - 1), 2 * random.next() - 1);
    light.box.extend(i % 17 == 5 ? Point<World>(0.5f, 0.5f, 0.5f) : p);
    if (i % 2 == 0) {
      light.box.extend(light.box.lower + Vector<World>(0.02f, 0.01f, 0.03f));
      const auto d = random.direction();
      light.axis = {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])};
      light.cosSpread = 1;
    }
    light.intensity = i % 41 == 7 ? 0 : std::exp(4 * random.next());
    lights.push_back(light);
  }
  return lights;
}

template <class Query>
::testing::AssertionResult followsItsProbabilities(const LightTree& tree, std::size_t count, const Query& query,
                                                   std::uint64_t seed) {
  constexpr int samples = 400000;
  std::vector<double> observed(count + 1), expected(count + 1);
  Uniforms random(seed);
  double total = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float p = tree.probability(query, i);
    if (!(p >= 0 && p <= 1)) return ::testing::AssertionFailure() << "probability " << p;
    expected[i] = samples * static_cast<double>(p);
    total += static_cast<double>(p);
  }
  if (!(total < 1 + 1e-4)) return ::testing::AssertionFailure() << "probabilities sum to " << total;
  expected[count] = samples * std::max(0.0, 1 - total);
  for (int i = 0; i < samples; ++i) {
    const auto choice = tree.choose(query, random.next());
    ++observed[choice ? choice->entry : count];
    if (!choice) continue;
    const float p = tree.probability(query, choice->entry);
    if (std::fabs(p / choice->probability - 1) > 1e-4f) {
      return ::testing::AssertionFailure() << "a choice says " << choice->probability << ", the tree " << p;
    }
    if (!(choice->rest >= 0 && choice->rest < 1)) return ::testing::AssertionFailure() << "rest " << choice->rest;
  }
  return countsAgree(observed, expected);
}

TEST(LightTree, FollowsItsProbabilitiesFromPoints) {
  const std::vector<LightBounds> lights = manyLights(700, seedOfTest());
  const LightTree tree(lights);
  for (const Point<World> p : {Point<World>(0, 0, 0), {0.5f, 0.5f, 0.5f}, {3, -1, 2}, {100, 0, 0}}) {
    EXPECT_TRUE(followsItsProbabilities(tree, lights.size(), PointQuery{p}, seedOfTest(1))) << p.x;
  }
}

TEST(LightTree, FollowsItsProbabilitiesFromRays) {
  const std::vector<LightBounds> lights = manyLights(700, seedOfTest());
  const LightTree tree(lights);
  Ray<World> ray;
  ray.origin = {-4, 0.1f, 0.2f};
  ray.direction = normalize(Vector<World>(1, 0.1f, -0.05f));
  volume::RayStretches stretches;
  stretches.add(2, 3.5);
  stretches.add(4, 7);
  EXPECT_TRUE(followsItsProbabilities(tree, lights.size(), RayQuery{ray, stretches}, seedOfTest(1)));
  volume::RayStretches endless;
  endless.add(0, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(followsItsProbabilities(tree, lights.size(), RayQuery{ray, endless}, seedOfTest(2)));
}

/// Every light is in one cluster of a cut, and each cluster's choices follow their probabilities.
template <class Query>
void expectACutOfAll(const LightTree& tree, std::size_t count, const Query& query, float threshold,
                     std::uint64_t seed) {
  const LightCut cut = tree.cut(query, threshold);
  ASSERT_GE(cut.count, 1u);
  ASSERT_LE(cut.count, LightCut::most);
  constexpr int samples = 60000;
  Uniforms random(seed);
  std::vector<double> observed(count);
  for (std::size_t k = 0; k < cut.count; ++k) {
    for (int i = 0; i < samples; ++i) {
      const auto choice = tree.chooseBelow(query, cut.nodes[k], random.next());
      if (!choice) continue;
      ++observed[choice->entry];
      const float p = tree.probability(query, choice->entry, cut);
      ASSERT_NEAR(p / choice->probability, 1, 1e-4f);
    }
  }
  std::vector<double> expected(count);
  double total = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float p = tree.probability(query, i, cut);
    ASSERT_TRUE(p >= 0 && p <= 1) << p;
    total += static_cast<double>(p);
    expected[i] = samples * static_cast<double>(p);
  }
  EXPECT_NEAR(total, static_cast<double>(cut.count), 0.05 * static_cast<double>(cut.count));
  // What no cluster's choice finds fills up both sides.
  observed.push_back(0);
  expected.push_back(samples * (static_cast<double>(cut.count) - total));
  double found = 0;
  for (const double n : observed) found += n;
  observed.back() = samples * static_cast<double>(cut.count) - found;
  if (expected.back() < 5) observed.back() = expected.back() = 0;
  EXPECT_TRUE(countsAgree(observed, expected));
}

TEST(LightTree, CutsHoldEveryLightOnce) {
  const std::vector<LightBounds> lights = manyLights(700, seedOfTest());
  const LightTree tree(lights);
  for (const Point<World> p : {Point<World>(0, 0, 0), {0.5f, 0.5f, 0.5f}, {3, -1, 2}, {100, 0, 0}}) {
    for (const float threshold : {0.5f, 0.1f, 0.0f}) {
      expectACutOfAll(tree, lights.size(), PointQuery{p}, threshold, seedOfTest(2));
    }
  }
  Ray<World> ray;
  ray.origin = {-4, 0.1f, 0.2f};
  ray.direction = normalize(Vector<World>(1, 0.1f, -0.05f));
  volume::RayStretches stretches;
  stretches.add(2, 7);
  expectACutOfAll(tree, lights.size(), RayQuery{ray, stretches}, 0.05f, seedOfTest(3));
}

/// The lower the threshold the more clusters; one where nothing is to be gained.
TEST(LightTree, SplitsWhereItMatters) {
  const std::vector<LightBounds> lights = manyLights(700, seedOfTest());
  const LightTree tree(lights);
  const auto countAt = [&](Point<World> p, float threshold) { return tree.cut(PointQuery{p}, threshold).count; };
  const Point<World> among(0.1f, 0.1f, 0.1f);
  EXPECT_EQ(countAt(among, neverSplit), 1u);
  EXPECT_EQ(countAt(among, 0.0f), LightCut::most);
  EXPECT_GE(countAt(among, 0.1f), countAt(among, 0.4f));
  EXPECT_GT(countAt(among, 0.1f), 1u);
  // From far away, lights of the same strength are as good as one.
  std::vector<LightBounds> alike = lights;
  for (LightBounds& light : alike) light.intensity = 1;
  const LightTree even(alike);
  EXPECT_EQ(even.cut(PointQuery{{100, 0, 0}}, 0.1f).count, 1u);
  EXPECT_GT(even.cut(PointQuery{among}, 0.1f).count, 1u);
}

/// A light whose normal, from some place of its box, is turned to the point has a positive probability.
TEST(LightTree, ForgetsNoLightThatCanBeSeen) {
  const std::vector<LightBounds> lights = manyLights(2000, seedOfTest());
  const LightTree tree(lights);
  Uniforms random(seedOfTest(1));
  int seen = 0;
  for (int i = 0; i < 200; ++i) {
    const Point<World> from(3 * random.next() - 1.5f, 3 * random.next() - 1.5f, 3 * random.next() - 1.5f);
    for (std::uint32_t k = 0; k < lights.size(); ++k) {
      const LightBounds& light = lights[k];
      const Vector<World> sides = light.box.upper - light.box.lower;
      const Point<World> place =
          light.box.lower + Vector<World>(sides.x * random.next(), sides.y * random.next(), sides.z * random.next());
      const bool isSeen = light.intensity > 0 && (light.cosSpread < 1 || dot(from - place, light.axis) > 1e-4f);
      if (!isSeen) continue;
      ++seen;
      ASSERT_GT(tree.probability(PointQuery{from}, k), 0);
    }
  }
  EXPECT_GT(seen, 100000);
}

/// Deeper than one entry a leaf: very many lights share leaves.
TEST(LightTree, SharesLeavesOfVeryManyLights) {
  const std::vector<LightBounds> lights = manyLights(LightTree::manyEntries + 1000, seedOfTest());
  const LightTree tree(lights);
  EXPECT_LT(tree.bytes(), 64 * lights.size());
  Uniforms random(seedOfTest(1));
  const PointQuery query{{0.2f, -0.3f, 0.1f}};
  double reachable = 0;
  for (std::uint32_t i = 0; i < lights.size(); ++i) reachable += tree.probability(query, i) > 0;
  double total = 0;
  for (std::uint32_t i = 0; i < lights.size(); ++i) total += static_cast<double>(tree.probability(query, i));
  EXPECT_NEAR(total, 1, 0.02);  // Clusters that turn out dark from here are found so late.
  for (int i = 0; i < 20000; ++i) {
    const auto choice = tree.choose(query, random.next());
    if (choice) {
      ASSERT_NEAR(tree.probability(query, choice->entry) / choice->probability, 1, 1e-3);
    }
  }
  EXPECT_GT(reachable, 1000);
}

/// 1,000 point lights as a scene has them: all their light arrives, and the choice along a ray is as its density says.
class ManyPoints : public ::testing::Test {
 protected:
  ManyPoints() {
    Registry registry;
    registerPlugins(registry);
    std::vector<std::unique_ptr<const Light>> lights;
    Uniforms random(seedOfTest());
    for (int i = 0; i < 1000; ++i) {
      const Point<scene::Unplaced> p(4 * random.next() - 2, 4 * random.next() - 2, 4 * random.next() - 2);
      const float intensity = std::exp(3 * random.next());
      positions_.push_back({p.x, p.y, p.z});
      intensities_.push_back(intensity);
      auto light = makeLight(registry, "point", {{"intensity", Color(intensity)}, {"position", p}}, nullptr);
      lights.push_back(std::move(*light));
    }
    auto sky = makeLight(registry, "constant", {{"radiance", Color(0.5f)}}, nullptr);
    lights.push_back(std::move(*sky));
    set_ = LightSet(std::move(lights), 3);
  }

  std::vector<Point<World>> positions_;
  std::vector<float> intensities_;
  LightSet set_;
};

TEST_F(ManyPoints, AllTheirLightArrives) {
  ASSERT_FALSE(set_.tree().isEmpty());
  const Point<World> from{0.3f, 2.5f, -0.4f};
  double truth = 0.5 * 4 * std::numbers::pi;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const Vector<World> d = positions_[i] - from;
    truth += static_cast<double>(intensities_[i]) / static_cast<double>(dot(d, d));
  }
  Uniforms random(seedOfTest(1));
  RunningMean arriving;
  for (int i = 0; i < 400000; ++i) {
    const auto s = set_.sample(from, random.next(), {random.next(), random.next2D()});
    arriving.add(s ? static_cast<double>(s->value.g / s->pdf) : 0);
  }
  EXPECT_TRUE(agrees(arriving, truth));
}

TEST_F(ManyPoints, AllTheirLightArrivesWhereClustersAreSplit) {
  for (const Point<World> from : {Point<World>(0.3f, 2.5f, -0.4f), {0.2f, 0.1f, 0.3f}}) {
    double truth = 0.5 * 4 * std::numbers::pi;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const Vector<World> d = positions_[i] - from;
      truth += static_cast<double>(intensities_[i]) / static_cast<double>(dot(d, d));
    }
    Uniforms random(seedOfTest(static_cast<std::uint64_t>(from.y * 10)));
    RunningMean single, split;
    std::uint64_t picked = 0;
    for (int i = 0; i < 200000; ++i) {
      const float u = random.next();
      const std::array<float, 2> place = random.next2D();
      const auto light = [&](const LightSet::Picks& picks) {
        double sum = 0;
        for (std::size_t k = 0; k < picks.count; ++k) {
          const auto choice = set_.choose(picks, k, from);
          if (!choice) continue;
          const auto s = set_.sample(choice->id(), from, {random.next(), place});
          if (s) sum += static_cast<double>(s->value.g / (s->pdf * choice->probability));
        }
        return sum;
      };
      const LightSet::Picks picks = set_.pick(from, u, 0.05f);
      picked += picks.count;
      split.add(light(picks));
      single.add(light(set_.pick(from, u, neverSplit)));
    }
    EXPECT_GT(picked, 400000u);
    EXPECT_TRUE(agrees(split, truth));
    EXPECT_LT(split.variance(), 0.6 * single.variance());
  }
}

/// E[f / density] over the choices is the sum over the lights of ∫ f along the ray, wherever every light may be chosen.
TEST_F(ManyPoints, TheChoiceAlongARayHasItsDensity) {
  Ray<World> ray;
  ray.origin = {-5, 0.2f, 0.1f};
  ray.direction = normalize(Vector<World>(1, 0.05f, 0.02f));
  volume::RayStretches stretches;
  stretches.add(2, 5);
  stretches.add(6, 8);
  const LightsAlongRay lights(set_, ray, stretches, LightChoice::equiangular);
  const LightsAlongRay split(set_, ray, stretches, LightChoice::equiangular, 0.05f);
  const auto falloff = [&](LightId id, double t) {
    const LightPlace place = *set_.placeOf(id);
    const Vector<World> d = place.centre - ray.at(static_cast<float>(t));
    return static_cast<double>(place.intensity) / static_cast<double>(dot(d, d));
  };
  const auto chanceOf = [&](std::uint32_t i, double t) { return lights.density(LightId{i, 0}, t); };
  double truth = 0;
  for (std::uint32_t i = 0; i < positions_.size(); ++i) {
    if (!(chanceOf(i, 3) > 0)) continue;
    const auto f = [&](double t) { return falloff(LightId{i, 0}, t); };
    truth += test::integrate(f, 2, 5, 400) + test::integrate(f, 6, 8, 400);
  }
  Uniforms random(seedOfTest(1));
  RunningMean sum, splitSum;
  for (int i = 0; i < 400000; ++i) {
    const std::array<float, 2> u = random.next2D();
    const auto valueOf = [&](const LightsAlongRay& from, std::size_t index) {
      const auto choice = from.choose(u, index);
      if (!choice) return 0.0;
      EXPECT_NEAR(from.density(choice->light, choice->t) / choice->density, 1, 1e-3);
      return falloff(choice->light, choice->t) / choice->density;
    };
    sum.add(valueOf(lights, 0));
    double all = 0;
    for (std::size_t k = 0; k < split.count(); ++k) all += valueOf(split, k);
    splitSum.add(all);
  }
  EXPECT_EQ(lights.count(), 1u);
  EXPECT_GT(split.count(), 2u);
  EXPECT_TRUE(agrees(sum, truth, 0.01));
  EXPECT_TRUE(agrees(splitSum, truth, 0.01));
  EXPECT_LT(splitSum.variance(), 0.7 * sum.variance());
}

/// A mesh that shines, triangle by triangle.
TEST(MeshInTheTree, AllItsLightArrives) {
  Registry registry;
  registerPlugins(registry);
  accel::TriangleMesh mesh;
  constexpr int n = 16;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const auto x = static_cast<float>(i) / n, y = static_cast<float>(j) / n;
      mesh.positions.push_back({x, y, 0.2f * std::sin(6 * x) * std::cos(5 * y)});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j;
      mesh.triangles.push_back({a, a + n + 1, a + 1});
      mesh.triangles.push_back({a + 1, a + n + 1, a + n + 2});
    }
  }
  accel::SceneBuilder builder;
  ASSERT_TRUE(builder.addMesh(mesh));
  auto scene = builder.build();
  ASSERT_TRUE(scene);
  std::shared_ptr<const LightSurface> surface = makeMeshLight(*scene->mesh(0));
  const auto alone = makeLight(registry, "area", {}, surface);
  auto inSet = makeLight(registry, "area", {}, surface);
  std::vector<std::unique_ptr<const Light>> lights;
  lights.push_back(std::move(*inSet));
  const LightSet set(std::move(lights), 1);
  ASSERT_FALSE(set.tree().isEmpty());
  for (const Point<World> from : {Point<World>(0.5f, 0.5f, 1), {0.1f, 0.9f, 0.3f}, {0.5f, 0.2f, -1}}) {
    Uniforms random(seedOfTest(static_cast<std::uint64_t>(from.z * 10 + 100)));
    RunningMean one, other;
    for (int i = 0; i < 400000; ++i) {
      const auto s = set.sample(from, random.next(), {random.next(), random.next2D()});
      one.add(s ? 1 / static_cast<double>(s->pdf) : 0);
      const auto t = (*alone)->sample(from, {random.next(), random.next2D()});
      other.add(t ? 1 / static_cast<double>(t->pdf) : 0);
      if (i >= 1000 || !s) continue;
      // The hit of a ray has the same density.
      accel::SpanBuffer spans;
      accel::Counters counters;
      Ray<World> ray;
      ray.origin = from;
      ray.direction = s->direction;
      const auto hit = scene->closestHit(ray, spans, counters);
      if (!hit || length(hit->point - s->point) > 1e-4f) continue;
      const float facing = -dot(s->direction, s->normal);
      const LightHit at{hit->point, hit->geometricNormal, ray.direction, hit->primitive};
      ASSERT_NEAR(set.pdf(0, from, at) / s->pdf, 1, 1e-3f + 3e-4f / (facing * facing));
    }
    const double error = std::hypot(one.standardError(), other.standardError());
    EXPECT_NEAR(one.mean(), other.mean(), 4 * error) << from.z;
    EXPECT_LE(one.standardError(), other.standardError()) << "the hierarchy is of no use";
  }
}

}  // namespace
}  // namespace aerosol::render

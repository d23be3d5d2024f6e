#include <gtest/gtest.h>

#include <numbers>

#include "core/render/closure_mix.h"
#include "core/render/registry.h"
#include "plugins/registration.h"
#include "tests/statistical/direction_grid.h"
#include "tests/statistical/statistics.h"

// Every registered closure, with parameters over their ranges, tilted shading normals and viewers from steep to
// grazing: samples as the density says, no energy gained, albedo as stated.

namespace aerosol::render {
namespace {

using test::agrees;
using test::countsAgree;
using test::DirectionGrid;
using test::RunningMean;
using test::seedOfTest;
using test::Uniforms;
using Parameters = std::vector<float>;

const Normal<World> geometricNormal = normalize(Normal<World>(0.3f, -0.5f, 0.8f));
constexpr int sampleCount = 200000;

Registry allPlugins() {
  Registry registry;
  registerPlugins(registry);
  return registry;
}

/// The direction at `angle` from the geometric normal.
Vector<World> tilted(double angle, double turn) {
  const Frame<World> frame(geometricNormal.vector());
  return normalize(frame.at(static_cast<float>(std::sin(angle) * std::cos(turn)),
                            static_cast<float>(std::sin(angle) * std::sin(turn)), static_cast<float>(std::cos(angle))));
}

/// Directions are shading normals, `tilt` off the geometric one; numbers lie at `place` of their range; colours are
/// white.
Parameters parametersAt(const Closure& closure, double place, double tilt) {
  Parameters parameters;
  for (const DescribedField& field : closure.fields()) {
    if (field.type == FieldType::direction) {
      const Vector<World> n = tilted(tilt, 1);
      parameters.insert(parameters.end(), {n.x, n.y, n.z});
    } else if (field.type == FieldType::color) {
      parameters.insert(parameters.end(), 3, 1.0f);
    } else if (field.type == FieldType::choice) {
      parameters.push_back(std::floor(static_cast<float>(place) * (static_cast<float>(field.choices.size()) - 0.5f)));
    } else {
      // Lobes are kept wide enough for the cells in which directions are counted.
      const float value = field.minimum + static_cast<float>(place) * (field.maximum - field.minimum);
      const bool isWidth =
          field.name.starts_with("roughness") || field.name.ends_with("alpha") || field.name.ends_with("rough");
      const bool isIndex = field.name == "ior" || field.name == "eta", isGloss = field.name.ends_with("_gloss");
      const float least = isWidth ? 0.5f : isIndex ? 1.6f : value;
      parameters.push_back(isGloss ? 0.0f : std::max(value, least));
    }
  }
  return parameters;
}

/// Mirrors and polished boundaries: no density anywhere, and no more light than arrives.
::testing::AssertionResult isDelta(const Closure& closure, const Parameters& p, const ClosurePoint& point,
                                   Uniforms& random) {
  RunningMean energy;
  for (int i = 0; i < 20000; ++i) {
    const auto s = closure.sample(p, point, {random.next(), random.next2D()});
    energy.add(s ? static_cast<double>(s->weight.g / s->radianceScale) : 0);
    if (!s) continue;
    const bool isSound = s->isDelta && s->pdf > 0 && s->pdf <= 1 && closure.pdf(p, point, s->direction) == 0 &&
                         isBlack(closure.evaluate(p, point, s->direction));
    if (!isSound) return ::testing::AssertionFailure() << "both delta and not";
  }
  const auto expected = static_cast<double>(closure.albedo(p, point).g);
  if (std::fabs(energy.mean() - expected) > 0.01) {
    return ::testing::AssertionFailure() << "scatters " << energy.mean() << ", says " << expected;
  }
  return ::testing::AssertionSuccess();
}

/// Chi-squared of the directions, absorbed ones in a cell of their own; pdf and weight of each; mean weight against the
/// integral of the closure.
::testing::AssertionResult samplesMatch(const Closure& closure, const Parameters& p, const ClosurePoint& point,
                                        Uniforms& random) {
  const DirectionGrid grid(geometricNormal.vector(), 2, 20, 16);
  // Lobes around the poles of the grid, where its cells are wide, need small steps.
  const int steps = closure.fields().size() > 1 ? 40 : 10;
  constexpr double tolerance = 1e-6;
  std::vector<double> expected =
      grid.integrateSmoothCells([&](Vector<World> d) { return closure.pdf(p, point, d); }, steps, tolerance);
  const std::vector<double> values =
      grid.integrateSmoothCells([&](Vector<World> d) { return closure.evaluate(p, point, d).g; }, steps, tolerance);
  double total = 0, energy = 0;
  for (double& e : expected) {
    total += e;
    e *= sampleCount;
  }
  for (const double v : values) energy += v;
  if (total > 1 + 1e-3 || (closure.traits().isBounded && energy > 1 + 1e-3)) {
    return ::testing::AssertionFailure() << "pdf integrates to " << total << ", the closure to " << energy;
  }
  expected.push_back(std::max(0.0, 1 - total) * sampleCount);
  std::vector<double> observed(expected.size());
  RunningMean weights;
  for (int i = 0; i < sampleCount; ++i) {
    const auto s = closure.sample(p, point, {random.next(), random.next2D()});
    weights.add(s ? static_cast<double>(s->weight.g) : 0);
    ++observed[s ? grid.cell(s->direction) : grid.cellCount()];
    if (!s) continue;
    const float density = closure.pdf(p, point, s->direction);
    const Color value = closure.evaluate(p, point, s->direction), weighted = s->weight * s->pdf;
    if (std::fabs(density - s->pdf) > 1e-4f * s->pdf ||
        maximum(abs(value - weighted)) > 1e-4f * maximum(value) + 1e-30f) {
      return ::testing::AssertionFailure() << "a sample says pdf " << s->pdf << ", the closure " << density;
    }
  }
  // Shading normals that the viewer sees from behind scatter nothing.
  if (total == 0 && energy == 0 && weights.mean() == 0) return ::testing::AssertionSuccess();
  // A thousandth may be missing from the quadrature of narrow lobes, which is not to be taken for absorption.
  if (const double absorbed = observed.back(); absorbed < 1e-3 * sampleCount && total > 1 - 2e-3) {
    for (double& e : expected) e *= (1 - absorbed / sampleCount) / total;
    expected.back() = absorbed;
  }
  if (const auto result = countsAgree(observed, expected); !result) return result;
  // What the quadrature itself cannot tell.
  if (std::fabs(weights.mean() - energy) < 3e-4 * energy) return ::testing::AssertionSuccess();
  // Of what scatters next to nothing the mean is told to 2e-3 of the light.
  return agrees(weights, energy, std::max(test::meanResolution, 2e-3 / energy));
}

::testing::AssertionResult check(const Closure& closure, const Parameters& p, const ClosurePoint& point,
                                 Uniforms& random) {
  const Color albedo = closure.albedo(p, point);
  if (minimum(albedo) < 0 || maximum(albedo) > 1) return ::testing::AssertionFailure() << "albedo out of range";
  if (closure.kind() == ClosureKind::scattering) {
    const auto first = closure.sample(p, point, {0.5f, {0.5f, 0.5f}});
    return first && first->isDelta ? isDelta(closure, p, point, random) : samplesMatch(closure, p, point, random);
  }
  const auto s = closure.sample(p, point, {random.next(), random.next2D()});
  const Vector<World> anywhere = tilted(0.4, 2);
  if (!isBlack(closure.evaluate(p, point, anywhere)) || closure.pdf(p, point, anywhere) != 0) {
    return ::testing::AssertionFailure() << "scatters, though it says otherwise";
  }
  if (closure.kind() == ClosureKind::subsurface) {
    const bool enters = s && s->isDelta && s->entersBody &&
                        dot(s->direction, geometricNormal) * dot(point.toViewer, geometricNormal) < 0 &&
                        std::fabs(length(s->direction) - 1) < 1e-5f && maximum(s->weight) <= 1 &&
                        minimum(s->weight) > 0;
    const SubsurfaceBody body = closure.body(p);
    const bool isSound = minimum(body.extinction) > 0 && isFinite(body.extinction) && minimum(body.albedo) >= 0 &&
                         maximum(body.albedo) <= 1 && std::fabs(body.anisotropy) < 1;
    return enters && isSound ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << "does not enter a body";
  }
  const bool isSilent = closure.kind() == ClosureKind::interior || closure.kind() == ClosureKind::holdout ||
                        closure.kind() == ClosureKind::shadowing || closure.kind() == ClosureKind::output;
  if (isSilent) return s ? ::testing::AssertionFailure() : ::testing::AssertionSuccess();
  if (closure.kind() == ClosureKind::emission) {
    return !s && isBlack(albedo) && !isBlack(closure.emitted(p, point)) ? ::testing::AssertionSuccess()
                                                                        : ::testing::AssertionFailure();
  }
  const bool passes = s && s->isDelta && s->isPassing && s->direction == -point.toViewer && s->weight == albedo;
  return passes ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << "does not pass straight on";
}

class EveryClosure : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryClosure, ScattersAsItSays) {
  const Registry registry = allPlugins();
  const Closure& closure = *registry.closure(GetParam());
  std::uint64_t setting = 0;
  for (const double tilt : {0.0, 0.5}) {
    for (const double view : {0.0, 0.8, 1.5}) {
      for (const double place : {0.05, 0.5, 1.0}) {
        const Parameters p = parametersAt(closure, place, tilt);
        Uniforms random(seedOfTest(setting++));
        EXPECT_TRUE(check(closure, p, {tilted(view, 4), geometricNormal}, random))
            << ::testing::PrintToString(p) << " view " << view;
        if (closure.fields().empty()) return;
      }
    }
  }
}

/// f / η² of the light's side is the same seen from either end, where a closure claims that.
TEST_P(EveryClosure, IsReciprocalWhereItSaysSo) {
  const Registry registry = allPlugins();
  const Closure& closure = *registry.closure(GetParam());
  if (closure.kind() != ClosureKind::scattering || !closure.traits().isReciprocal) return;
  Uniforms random(seedOfTest());
  for (const double place : {0.05, 0.5, 1.0}) {
    const Parameters p = parametersAt(closure, place, 0);
    for (int i = 0; i < 200; ++i) {
      const auto [x, y] = random.next2D();
      const Vector<World> a = tilted(1.5 * static_cast<double>(x), 6 * static_cast<double>(y)),
                          b = tilted(3.1 * static_cast<double>(y), 5 * static_cast<double>(random.next()));
      const auto f = [&](Vector<World> viewer, Vector<World> light) {
        return closure.evaluate(p, {viewer, geometricNormal}, light).g / std::fabs(dot(light, geometricNormal));
      };
      EXPECT_NEAR(f(a, b), f(b, a), 1e-4f * std::max(1.0f, f(a, b)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Closures, EveryClosure, ::testing::ValuesIn([] {
                           std::vector<std::string> names;
                           const Registry registry = allPlugins();
                           for (const auto& closure : registry.closures()) names.emplace_back(closure->name());
                           return names;
                         }()),
                         [](const auto& suite) { return suite.param; });

TEST(Closures, NamesAreUnique) {
  const Registry registry = allPlugins();
  ASSERT_FALSE(registry.closures().empty());
  for (const auto& closure : registry.closures()) {
    EXPECT_EQ(registry.closure(closure->name()), closure.get()) << closure->name();
  }
}

/// What is scattered of light from everywhere, over the additive recurrence of Roberts 2018 in three dimensions: within
/// 2e-4 for the lobes asked here.
double energyOf(const Closure& closure, const Parameters& p, const ClosurePoint& point, int count = 20000) {
  double energy = 0;
  for (int i = 0; i < count; ++i) {
    const auto part = [i](double step) { return static_cast<float>(std::fmod(0.5 + step * i, 1)); };
    const auto s =
        closure.sample(p, point, {part(0.8191725133961645), {part(0.6710436067037893), part(0.5497004779019703)}});
    energy += s ? static_cast<double>(s->weight.g / s->radianceScale) : 0;
  }
  return energy / count;
}

/// Facets of mirrors of every width and shape: less than a hundredth of the light is lost, none is gained.
TEST(Closures, MicrofacetsKeepTheLightInAWhiteFurnace) {
  const Registry registry = allPlugins();
  const Vector<World> n = tilted(0, 0), across = Frame<World>(n).x;
  for (const float shape : {0.0f, 1.0f}) {
    for (const float x : {0.05f, 0.2f, 0.5f, 0.8f, 1.0f}) {
      for (const float ratio : {1.0f, 0.6f, 0.2f}) {
        for (const double view : {0.1, 0.9, 1.3}) {
          const ClosurePoint point{tilted(view, 4), geometricNormal};
          const Parameters metal{n.x, n.y, n.z, across.x, across.y, across.z, x, x * ratio, 0,
                                 0,   0,   1,   1,        1,        shape,    0, 1};
          const double reflected = energyOf(*registry.closure("conductor_bsdf"), metal, point);
          EXPECT_GE(reflected, 0.99) << "metal " << shape << ' ' << x << ' ' << ratio << ' ' << view;
          EXPECT_LE(reflected, 1.0002) << "metal " << shape << ' ' << x << ' ' << ratio << ' ' << view;
        }
      }
    }
  }
}

TEST(Closures, AlbedoIsTheMeanWeightSeenStraightOn) {
  const Registry registry = allPlugins();
  for (const auto& closure : registry.closures()) {
    if (closure->kind() != ClosureKind::scattering || !closure->traits().hasExactAlbedo) continue;
    Parameters p = parametersAt(*closure, 0, 0);
    std::size_t at = 0;
    for (const DescribedField& field : closure->fields()) {
      if (field.name.starts_with("roughness")) p[at] = 0.05f;
      at += static_cast<std::size_t>(field.components());
    }
    const ClosurePoint point{tilted(0.2, 4), geometricNormal};
    Uniforms random(seedOfTest());
    RunningMean weights;
    for (int i = 0; i < 50000; ++i) {
      const auto s = closure->sample(p, point, {random.next(), random.next2D()});
      weights.add(s ? static_cast<double>(s->weight.g / s->radianceScale) : 0);
    }
    // Microfacets that hide each other lose a little.
    EXPECT_NEAR(weights.mean(), static_cast<double>(closure->albedo(p, point).g), 0.01) << closure->name();
  }
}

/// Fibres that absorb nothing, of every width and tilt.
TEST(Closures, FibresKeepTheLightInAWhiteFurnace) {
  const Registry registry = allPlugins();
  const Closure& hair = *registry.closure("chiang_hair_bsdf");
  const Vector<World> n = tilted(0, 0), along = Frame<World>(n).x;
  for (const float width : {0.02f, 0.2f, 0.8f}) {
    for (const float tilt : {0.5f, 0.53f, 0.45f}) {
      for (const double view : {0.0, 0.7, 1.3}) {
        const Parameters p{n.x, n.y, n.z,   along.x, along.y,   along.z,   1,     1,     1,     1,    1, 1, 1,
                           1,   1,   1.55f, width,   width / 4, width * 4, width, width, width, tilt, 0, 0, 0};
        const ClosurePoint point{tilted(view, 2), geometricNormal};
        EXPECT_NEAR(hair.albedo(p, point).g, 1, 1e-5f);
        EXPECT_NEAR(energyOf(hair, p, point), 1, 0.004) << width << ' ' << tilt << ' ' << view;
      }
    }
  }
}

/// What passes a fibre straight across twice is dimmed by its absorption; what is reflected is not.
TEST(Closures, FibresAbsorbAlongTheWayInside) {
  const Registry registry = allPlugins();
  const Closure& hair = *registry.closure("chiang_hair_bsdf");
  const Vector<World> n = tilted(0, 0), along = Frame<World>(n).x;
  Parameters p{n.x, n.y, n.z,  along.x, along.y, along.z, 1,    1,    1,    1,    1,    1,    1,
               1,   1,   1.5f, 0.1f,    0.1f,    0.1f,    0.2f, 0.2f, 0.2f, 0.5f, 0.1f, 0.5f, 3};
  const Color found = hair.albedo(p, {n, geometricNormal});
  for (int c = 0; c < 3; ++c) {
    const double f = 0.04, t = std::exp(-2 * static_cast<double>(p[static_cast<std::size_t>(23 + c)]));
    EXPECT_NEAR(static_cast<double>(found[c]), f + (1 - f) * (1 - f) * t / (1 - f * t), 1e-5);
  }
  // Tints are those of the lobes.
  for (std::size_t i = 6; i < 15; ++i) p[i] = i < 9 ? 0.5f : 0;
  EXPECT_NEAR(hair.albedo(p, {n, geometricNormal}).r, 0.02f, 1e-5f);
}

/// From within the denser side too: refraction changes radiance by the square of the index, energy not at all.
TEST(Closures, DielectricsKeepTheEnergy) {
  const Registry registry = allPlugins();
  const Closure& dielectric = *registry.closure("dielectric_bsdf");
  std::uint64_t setting = 0;
  for (const float roughness : {0.0f, 0.05f, 0.2f}) {
    for (const float ior : {1.0f, 1.33f, 1.5f, 2.4f}) {
      for (const double view : {0.1, 0.8, 1.4, 1.8, 2.6, 3.0}) {
        Parameters p = parametersAt(dielectric, 0, 0);
        p[12] = p[13] = roughness;
        p[14] = ior;
        const ClosurePoint point{tilted(view, 4), geometricNormal};
        Uniforms random(seedOfTest(setting++));
        RunningMean energy;
        for (int i = 0; i < 20000; ++i) {
          const auto s = dielectric.sample(p, point, {random.next(), random.next2D()});
          energy.add(s ? static_cast<double>(s->weight.g / s->radianceScale) : 0);
          const bool refracts = s && dot(s->direction, geometricNormal) * dot(point.toViewer, geometricNormal) < 0;
          const float eta = view < 1.57 ? ior : 1 / ior;
          if (s) EXPECT_FLOAT_EQ(s->radianceScale, refracts ? 1 / (eta * eta) : 1);
        }
        const double grazing = std::fabs(std::cos(view));
        const double loss = roughness == 0 ? 1e-4 : grazing < 0.3 ? 0.2 : roughness > 0.1f ? 0.1 : 0.03;
        EXPECT_LE(energy.mean(), 1.003) << roughness << ' ' << ior << ' ' << view;
        EXPECT_GE(energy.mean(), 1 - loss) << roughness << ' ' << ior << ' ' << view;
      }
    }
  }
}

/// The parameters of a white boundary, as each closure takes them.
Parameters whiteBoundary(std::string_view closure, float shape, float x, float y, float ior, float film_nm) {
  const Vector<World> n = tilted(0, 0), across = Frame<World>(n).x;
  const float f0 = (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1));
  if (closure == "microfacet") return {shape, n.x, n.y, n.z, across.x, across.y, across.z, x, y, -1, ior, 2};
  Parameters p{n.x, n.y, n.z, across.x, across.y, across.z, 1, 1, 1, 1, 1, 1, x, y};
  if (closure == "dielectric_bsdf") {
    p.push_back(ior);
  } else {
    p.insert(p.end(), {0.5f * f0, f0, 1.5f * f0, 1, 0.9f, 0.8f, 4});
  }
  p.insert(p.end(), {shape, film_nm, 1.3f});
  return p;
}

/// Boundaries of every width, shape, direction and index, from both sides, by Fresnel's reflectance, Schlick's and a
/// film's: none of the light is lost, none is gained.
TEST(Closures, BoundariesKeepTheLightInAWhiteFurnace) {
  const Registry registry = allPlugins();
  for (const std::string_view name : {"dielectric_bsdf", "generalized_schlick_bsdf", "microfacet"}) {
    for (const float x : {0.05f, 0.1f, 0.4f, 0.7f, 1.0f}) {
      for (const float ratio : {1.0f, 0.3f, 0.05f}) {
        for (const float ior : {1.01f, 1.2f, 1.5f, 2.4f, 4.0f}) {
          for (const double view : {0.1, 0.8, 1.3, 1.55, 1.6, 1.9, 2.4, 3.0}) {
            const float film = ratio == 0.3f && x == 0.4f && name != "microfacet" ? 400.0f : 0.0f;
            const ClosurePoint point{tilted(view, 4), geometricNormal};
            const Parameters p = whiteBoundary(name, 0, x, x * ratio, ior, film);
            const double kept = energyOf(*registry.closure(name), p, point, 2000);
            EXPECT_NEAR(kept, 1, film > 0 ? 0.01 : 1e-4)
                << name << ' ' << x << ' ' << ratio << ' ' << ior << ' ' << view;
          }
        }
      }
    }
  }
}

/// Beckmann's facets are drawn as if they were GGX's and weighed: what differs from 1 is the error of the samples.
TEST(Closures, BoundariesOfBeckmannFacetsKeepTheLight) {
  const Registry registry = allPlugins();
  for (const std::string_view name : {"dielectric_bsdf", "generalized_schlick_bsdf"}) {
    for (const float x : {0.1f, 0.4f, 1.0f}) {
      for (const float ratio : {1.0f, 0.2f}) {
        for (const float ior : {1.2f, 2.4f}) {
          for (const double view : {0.1, 1.3, 1.55, 1.9, 3.0}) {
            const ClosurePoint point{tilted(view, 4), geometricNormal};
            const Parameters p = whiteBoundary(name, 1, x, x * ratio, ior, 0);
            EXPECT_NEAR(energyOf(*registry.closure(name), p, point), 1, 0.005)
                << name << ' ' << x << ' ' << ratio << ' ' << ior << ' ' << view;
          }
        }
      }
    }
  }
}

/// Disney's materials add parts that know nothing of each other: their sum still gives no more than it gets.
TEST(Closures, ArtistsMaterialsGainNothingInAWhiteFurnace) {
  const Registry registry = allPlugins();
  const Vector<World> n = tilted(0, 0), across = Frame<World>(n).x;
  Uniforms random(seedOfTest());
  double most = 0;
  for (int i = 0; i < 200; ++i) {
    const auto pick = [&] { return std::clamp(1.4f * static_cast<float>(random.next()) - 0.2f, 0.0f, 1.0f); };
    Parameters p{n.x, n.y, n.z, across.x, across.y, across.z, 1, i % 2 == 0 ? 1.0f : pick(), 1};
    const bool isThin = i % 3 == 0;
    // Mirrors are too narrow to be seen in so few samples of the other parts.
    p.insert(p.end(), {std::max(pick(), 0.25f), i % 4 == 0 ? pick() : 0});
    if (!isThin) p.push_back(i % 5 == 0 ? pick() : 0);
    p.insert(p.end(), {pick(), 1.1f + pick(), pick(), pick(), pick(), pick()});
    if (isThin) {
      p.push_back(2 * pick());
    } else {
      p.insert(p.end(), {pick(), pick()});
    }
    const ClosurePoint point{tilted(1.5 * random.next(), 4), geometricNormal};
    const double kept =
        energyOf(*registry.closure(isThin ? "principled_thin_bsdf" : "principled_bsdf"), p, point, 8000);
    EXPECT_LE(kept, 1.005) << i;
    most = std::max(most, kept);
  }
  EXPECT_GT(most, 0.97) << "dimmed where there is no need";
}

/// What `layer` leaves to a base below is one less the albedo: that of the two sides by themselves is what they
/// scatter.
TEST(Closures, AlbedosOfBoundariesAreWhatTheyScatter) {
  const Registry registry = allPlugins();
  for (const std::string_view name : {"dielectric_bsdf", "generalized_schlick_bsdf"}) {
    for (const float x : {0.1f, 0.5f, 1.0f}) {
      for (const float ratio : {1.0f, 0.2f}) {
        for (const float film : {0.0f, 500.0f}) {
          for (const double view : {0.1, 0.9, 1.4, 1.9, 2.8}) {
            for (const bool reflects : {true, false}) {
              Parameters p = whiteBoundary(name, 0, x, x * ratio, 1.5f, film);
              std::fill_n(p.begin() + (reflects ? 9 : 6), 3, 0.0f);
              const ClosurePoint point{tilted(view, 4), geometricNormal};
              const double stated = static_cast<double>(registry.closure(name)->albedo(p, point).g);
              // From inside the edge of total reflection is narrower than the table's steps.
              EXPECT_NEAR(energyOf(*registry.closure(name), p, point, 8000), stated, view < 1.5 ? 0.01 : 0.025)
                  << name << ' ' << x << ' ' << ratio << ' ' << film << ' ' << view << ' ' << reflects;
            }
          }
        }
      }
    }
  }
}

TEST(Closures, SmoothDielectricsBendLightBySnellsLaw) {
  const Registry registry = allPlugins();
  const Closure& dielectric = *registry.closure("dielectric_bsdf");
  Parameters p = parametersAt(dielectric, 0, 0);
  p[12] = p[13] = 0;
  for (const auto& [near, far] : {std::pair(1.0f, 1.5f), std::pair(1.5f, 1.33f), std::pair(1.33f, 1.0f)}) {
    for (const double view : {0.2, 0.5, 0.7, 2.7}) {
      ClosurePoint point{tilted(view, 4), geometricNormal};
      point.iorNear = near;
      point.iorFar = far;
      const auto s = dielectric.sample(p, point, {0x1.fffffep-1f, {0.5f, 0.5f}});
      ASSERT_TRUE(s && s->isDelta);
      const auto sine = [](Vector<World> w) { return length(cross(w, geometricNormal.vector())); };
      EXPECT_NEAR(near * sine(point.toViewer), far * sine(s->direction), 1e-5f);
      EXPECT_LT(dot(s->direction, geometricNormal) * dot(point.toViewer, geometricNormal), 0);
      EXPECT_NEAR(dot(s->direction, cross(point.toViewer, geometricNormal.vector())), 0, 1e-6f) << "in one plane";
    }
  }
}

/// A mixture is a closure like any other: tested as one.
class Mixture final : public Closure {
 public:
  Mixture(std::span<const WeightedClosure> terms, const ClosurePoint& point) : mix_(terms, point) {}
  std::string_view name() const override { return "mixture"; }
  std::string_view doc() const override { return ""; }
  std::span<const DescribedField> fields() const override { return {}; }
  ClosureKind kind() const override { return ClosureKind::scattering; }
  Color evaluate(std::span<const float>, const ClosurePoint&, Vector<World> d) const override {
    return mix_.evaluate(d);
  }
  float pdf(std::span<const float>, const ClosurePoint&, Vector<World> d) const override { return mix_.pdf(d); }
  std::optional<ClosureSample> sample(std::span<const float>, const ClosurePoint&,
                                      const ClosureUniforms& u) const override {
    return mix_.sample(u);
  }

 private:
  ClosureMix mix_;
};

TEST(Closures, MixturesOfScatteringClosures) {
  const Registry registry = allPlugins();
  const ClosurePoint point{tilted(0.5, 4), geometricNormal};
  std::vector<Parameters> parameters;
  std::vector<WeightedClosure> terms;
  parameters.reserve(100);
  for (const double tilt : {0.1, 0.4}) {
    for (const auto& closure : registry.closures()) {
      const auto names = {"diffuse", "dielectric_bsdf", "conductor_bsdf", "sheen_bsdf"};
      if (std::find(names.begin(), names.end(), closure->name()) == names.end()) continue;
      parameters.push_back(parametersAt(*closure, 0.5, tilt));
      const float weight = tilt < 0.2 ? 0.04f : 0.2f;
      terms.push_back({closure.get(), Color(0.1f, weight, 0.3f), parameters.back()});
    }
  }
  Uniforms random(seedOfTest());
  EXPECT_TRUE(samplesMatch(Mixture(terms, point), {}, point, random));
}

TEST(Closures, AMixtureWithTransparencyKeepsBothParts) {
  const Registry registry = allPlugins();
  const ClosurePoint point{tilted(0.5, 4), geometricNormal};
  const Vector<World> n = tilted(0, 0);
  const Parameters normal{n.x, n.y, n.z};
  const WeightedClosure terms[] = {{registry.closure("diffuse"), Color(0.5f), normal},
                                   {registry.closure("transparent"), Color(0.3f), {}},
                                   {registry.closure("emission"), Color(7), {}}};
  const ClosureMix mix(terms, point);
  EXPECT_EQ(mix.emitted(), Color(7));
  EXPECT_EQ(mix.transparency(), Color(0.3f));
  EXPECT_FALSE(mix.isPassing());
  Uniforms random(seedOfTest());
  RunningMean reflected, passed;
  for (int i = 0; i < 200000; ++i) {
    const auto s = mix.sample({random.next(), random.next2D()});
    reflected.add(s && !s->isPassing ? static_cast<double>(s->weight.r) : 0);
    passed.add(s && s->isPassing ? static_cast<double>(s->weight.r) : 0);
  }
  EXPECT_TRUE(agrees(reflected, 0.5));
  EXPECT_TRUE(agrees(passed, 0.3, 0.005));
}

/// Another closure with one thing 2% wrong.
class Planted final : public Closure {
 public:
  enum class Fault { none, value, pdf, weight, sampling };
  Planted(const Closure& inner, Fault fault) : inner_(inner), fault_(fault) {}
  std::string_view name() const override { return inner_.name(); }
  std::string_view doc() const override { return inner_.doc(); }
  std::span<const DescribedField> fields() const override { return inner_.fields(); }
  ClosureKind kind() const override { return inner_.kind(); }
  Color evaluate(std::span<const float> p, const ClosurePoint& point, Vector<World> d) const override {
    return inner_.evaluate(p, point, d) * (fault_ == Fault::value ? 0.98f : 1.0f);
  }
  float pdf(std::span<const float> p, const ClosurePoint& point, Vector<World> d) const override {
    return inner_.pdf(p, point, d) * (fault_ == Fault::pdf ? 0.98f : 1.0f);
  }
  std::optional<ClosureSample> sample(std::span<const float> p, const ClosurePoint& point,
                                      const ClosureUniforms& u) const override {
    ClosureUniforms used = u;
    if (fault_ == Fault::sampling) used.place[0] *= 0.98f;
    auto s = inner_.sample(p, point, used);
    if (s && fault_ == Fault::weight) s->weight *= 0.98f;
    return s;
  }
  Color albedo(std::span<const float> p, const ClosurePoint& point) const override { return inner_.albedo(p, point); }

 private:
  const Closure& inner_;
  Fault fault_;
};

/// Smooth meshes seen from their back: light may lie before the shading normal and behind the surface, as the viewer
/// does, and what reflects on one side only stays dark.
TEST(Closures, WhatReflectsIsDarkFromBehind) {
  const Registry registry = allPlugins();
  for (const char* name : {"diffuse", "oren_nayar", "oren_nayar_diffuse_bsdf", "burley_diffuse_bsdf", "phong", "ward",
                           "sheen_bsdf", "conductor_bsdf"}) {
    const Closure& closure = *registry.closure(name);
    Uniforms random(seedOfTest());
    const Parameters p = parametersAt(closure, 0.5, 0.5);
    const Vector<World> normal(p[0], p[1], p[2]);
    int lights = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto [x, y] = random.next2D();
      const auto [z, w] = random.next2D();
      const ClosurePoint point{tilted(std::numbers::pi * static_cast<double>(x), 7 * static_cast<double>(y)),
                               geometricNormal};
      const Vector<World> light = tilted(std::numbers::pi * static_cast<double>(z), 7 * static_cast<double>(w));
      if (dot(point.toViewer, geometricNormal) >= 0 || dot(point.toViewer, normal) >= 0) continue;
      lights += dot(light, geometricNormal) < 0 && dot(light, normal) > 0;
      EXPECT_TRUE(isBlack(closure.evaluate(p, point, light))) << name;
      EXPECT_EQ(closure.pdf(p, point, light), 0) << name;
      EXPECT_FALSE(closure.sample(p, point, {random.next(), random.next2D()})) << name;
      EXPECT_TRUE(isBlack(closure.albedo(p, point))) << name;
    }
    EXPECT_GT(lights, 20) << name;
  }
}

TEST(Closures, APlantedErrorOfTwoPercentIsCaught) {
  const Registry registry = allPlugins();
  const Closure& diffuse = *registry.closure("diffuse");
  const Parameters p = parametersAt(diffuse, 0.5, 0.2);
  const ClosurePoint point{tilted(0.5, 4), geometricNormal};
  for (const auto fault :
       {Planted::Fault::value, Planted::Fault::pdf, Planted::Fault::weight, Planted::Fault::sampling}) {
    Uniforms random(seedOfTest());
    EXPECT_FALSE(check(Planted(diffuse, fault), p, point, random)) << static_cast<int>(fault);
  }
  Uniforms random(seedOfTest());
  EXPECT_TRUE(check(Planted(diffuse, Planted::Fault::none), p, point, random));
}

}  // namespace
}  // namespace aerosol::render

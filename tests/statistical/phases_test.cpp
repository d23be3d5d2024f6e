#include <gtest/gtest.h>

#include "core/render/registry.h"
#include "core/volume/phase_mixture.h"
#include "core/volume/tabulated_phase.h"
#include "plugins/registration.h"
#include "tests/statistical/statistics.h"

// Every registered phase function, at parameters all over their ranges and next to their ends: normalised, mean cosine
// as stated, samples as the density says.

namespace aerosol::render {
namespace {

using test::agrees;
using test::countsAgree;
using test::integrate;
using test::RunningMean;
using test::seedOfTest;
using test::Uniforms;
using volume::Deflection;
using volume::PhaseFunction;
using volume::PhaseSample;
using Parameters = std::vector<float>;

Registry allPlugins() {
  Registry registry;
  registerPlugins(registry);
  return registry;
}

/// Each parameter at places of its range with the others in the middle: ends, near ends, middle, and 1e-8 beside it.
std::vector<Parameters> settings(const PhaseFunction& phase) {
  std::vector<Parameters> all;
  const auto fields = phase.fields();
  const auto middle = [&](std::size_t i) { return 0.5 * (double{fields[i].minimum} + double{fields[i].maximum}); };
  for (std::size_t varied = 0; varied < std::max<std::size_t>(1, fields.size()); ++varied) {
    for (const double place : {-1.0, -0.9999, -0.6, -1e-8, 0.0, 1e-8, 0.3, 0.9, 0.9999, 1.0}) {
      Parameters parameters;
      for (std::size_t i = 0; i < fields.size(); ++i) {
        const double half = 0.5 * (double{fields[i].maximum} - double{fields[i].minimum});
        parameters.push_back(static_cast<float>(middle(i) + (i == varied ? place * half : 0)));
      }
      all.push_back(parameters);
    }
  }
  return all;
}

/// Deflections on a scale that resolves both directions: 1 - cos = e^(-steepest s) for s > 0, its mirror image for s <
/// 0.
constexpr double steepest = 36;  // e^-36 = 2e-16

Deflection deflectionAt(double s) {
  const double small = std::exp(-steepest * std::fabs(s));
  return s >= 0 ? Deflection{small, 2 - small} : Deflection{2 - small, small};
}
double scaleOf(const Deflection& d) {
  const bool isForward = d.oneMinusCosine <= d.onePlusCosine;
  const double s = -std::log(std::max(1e-300, isForward ? d.oneMinusCosine : d.onePlusCosine)) / steepest;
  return (isForward ? 1 : -1) * std::clamp(s, 0.0, 1.0);
}
/// ∫ f p dω over s in [a, b], all azimuths. Both signs of zero are cos = 0.
template <class Function>
double integrateOver(double a, double b, int pieces, Function f) {
  return integrate(
      [&](double s) {
        const double small = std::exp(-steepest * std::fabs(s));
        return 2 * std::numbers::pi * steepest * small * f(deflectionAt(s));
      },
      a, b, pieces);
}

::testing::AssertionResult isNormalised(const PhaseFunction& phase, const Parameters& p) {
  const auto value = [&](const Deflection& d) { return static_cast<double>(phase.evaluate(p, d)); };
  const auto density = [&](const Deflection& d) { return static_cast<double>(phase.pdf(p, d)); };
  const auto cosine = [&](const Deflection& d) { return value(d) * d.cosine(); };
  const double total = integrateOver(-1, 0, 400, value) + integrateOver(0, 1, 400, value);
  const double totalDensity = integrateOver(-1, 0, 400, density) + integrateOver(0, 1, 400, density);
  const double mean = integrateOver(-1, 0, 400, cosine) + integrateOver(0, 1, 400, cosine);
  if (std::fabs(total - 1) > 1e-5 || std::fabs(totalDensity - 1) > 1e-5 ||
      std::fabs(mean - static_cast<double>(phase.meanCosine(p))) > 1e-5) {
    return ::testing::AssertionFailure() << "integral " << total << ", of the pdf " << totalDensity << ", mean cosine "
                                         << mean;
  }
  return ::testing::AssertionSuccess();
}

Vector<World> toVector(const std::array<double, 3>& d) {
  return normalize(Vector<World>(static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])));
}

constexpr int cells = 120, sectors = 8, sampleCount = 200000;

/// Chi-squared over deflection and azimuth; each sample's own pdf and weight; the mean of weight (1 + cos / 2).
::testing::AssertionResult samplesMatch(const PhaseFunction& phase, const Parameters& p, Uniforms& random) {
  std::vector<double> observed(cells * sectors), expected;
  for (int i = 0; i < cells; ++i) {
    const double a = 2.0 * i / cells - 1, b = 2.0 * (i + 1) / cells - 1;
    const double mass =
        integrateOver(a, b, 8, [&](const Deflection& d) { return static_cast<double>(phase.pdf(p, d)); });
    expected.insert(expected.end(), sectors, mass * sampleCount / sectors);
  }
  RunningMean mean;
  Vector<World> before{0, 0, 1};
  for (int i = 0; i < sampleCount; ++i) {
    if (i % 1000 == 999) before = toVector(random.direction());
    const PhaseSample s = phase.sample(p, before, random.next2D());
    if (std::fabs(length(s.direction) - 1) > 1e-6f) return ::testing::AssertionFailure() << "not a unit vector";
    const Deflection d = Deflection::between(before, s.direction);
    const double density = static_cast<double>(phase.pdf(p, d)), value = static_cast<double>(phase.evaluate(p, d));
    // A direction in float has an error of 1e-7, of which the density of a narrow peak makes more.
    const double angle = std::sqrt(2 * std::min(d.oneMinusCosine, d.onePlusCosine));
    const double tolerance = 1e-4 + 3e-6 / std::max(angle, 1e-4);
    if (std::fabs(density / static_cast<double>(s.pdf) - 1) > tolerance ||
        std::fabs(value / static_cast<double>(s.weight * s.pdf) - 1) > tolerance) {
      return ::testing::AssertionFailure() << "a sample says pdf " << s.pdf << " weight " << s.weight
                                           << ", the function " << density << ' ' << value << " at angle " << angle;
    }
    const Frame<World> frame(before);
    const double turn =
        std::atan2(static_cast<double>(dot(s.direction, frame.y)), static_cast<double>(dot(s.direction, frame.x)));
    const int cell = std::clamp(static_cast<int>((scaleOf(d) + 1) / 2 * cells), 0, cells - 1);
    const int sector = std::clamp(static_cast<int>((turn / (2 * std::numbers::pi) + 0.5) * sectors), 0, sectors - 1);
    ++observed[static_cast<std::size_t>(cell * sectors + sector)];
    mean.add(static_cast<double>(s.weight) * (1 + 0.5 * d.cosine()));
  }
  if (const auto result = countsAgree(observed, expected); !result) return result;
  return agrees(mean, 1 + 0.5 * static_cast<double>(phase.meanCosine(p)));
}

/// All light in one direction.
::testing::AssertionResult isDelta(const PhaseFunction& phase, const Parameters& p, Uniforms& random) {
  for (int i = 0; i < 1000; ++i) {
    const Vector<World> before = toVector(random.direction());
    const PhaseSample s = phase.sample(p, before, random.next2D());
    const double mean = static_cast<double>(dot(before, s.direction));
    if (!s.isDelta || s.weight != 1 || s.pdf != 1 || phase.pdf(p, Deflection::fromCosine(0.5)) != 0 ||
        std::fabs(mean - static_cast<double>(phase.meanCosine(p))) > 1e-5) {
      return ::testing::AssertionFailure() << "not a single direction";
    }
  }
  return ::testing::AssertionSuccess();
}

::testing::AssertionResult check(const PhaseFunction& phase, const Parameters& p, Uniforms& random) {
  if (phase.sample(p, {0, 0, 1}, {0.5f, 0.5f}).isDelta) return isDelta(phase, p, random);
  if (const auto result = isNormalised(phase, p); !result) return result;
  return samplesMatch(phase, p, random);
}

TEST(Phases, EveryRegisteredOne) {
  const Registry registry = allPlugins();
  ASSERT_FALSE(registry.phases().empty());
  for (const auto& phase : registry.phases()) {
    ASSERT_EQ(registry.phase(phase->name()), phase.get()) << "names are unique";
    std::uint64_t setting = 0;
    for (const Parameters& p : settings(*phase)) {
      Uniforms random(seedOfTest(setting++));
      EXPECT_TRUE(check(*phase, p, random)) << phase->name() << ' ' << ::testing::PrintToString(p);
    }
  }
}

TEST(Phases, Assembled) {
  const Registry registry = allPlugins();
  const auto registered = [&](const char* name) {
    return std::shared_ptr<const PhaseFunction>(std::shared_ptr<const PhaseFunction>(), registry.phase(name));
  };
  using volume::PhaseMixture;
  const PhaseMixture mixture({{1, registered("henyey_greenstein"), {0.97f}}, {0.5f, registered("draine"), {-0.3f, 4}}});
  const volume::TabulatedPhase table({0.5f, 0, 2});
  const PhaseMixture nested({{1, {std::shared_ptr<const PhaseFunction>(), &table}, {}},
                             {3, {std::shared_ptr<const PhaseFunction>(), &mixture}, {}}});
  std::uint64_t setting = 0;
  for (const PhaseFunction* phase :
       {static_cast<const PhaseFunction*>(&mixture), static_cast<const PhaseFunction*>(&table),
        static_cast<const PhaseFunction*>(&nested)}) {
    Uniforms random(seedOfTest(setting++));
    EXPECT_TRUE(check(*phase, {}, random)) << phase->name();
  }
}

/// Another phase function with one thing 2% wrong.
class Planted final : public PhaseFunction {
 public:
  enum class Fault { none, value, pdf, weight, sampling };
  Planted(const PhaseFunction& inner, Fault fault) : inner_(inner), fault_(fault) {}

  std::string_view name() const override { return inner_.name(); }
  std::string_view doc() const override { return inner_.doc(); }
  std::span<const DescribedField> fields() const override { return inner_.fields(); }
  float evaluate(std::span<const float> p, const Deflection& d) const override {
    return inner_.evaluate(p, d) * (fault_ == Fault::value ? 1.02f : 1.0f);
  }
  float pdf(std::span<const float> p, const Deflection& d) const override {
    return inner_.pdf(p, d) * (fault_ == Fault::pdf ? 1.02f : 1.0f);
  }
  PhaseSample sample(std::span<const float> p, Vector<World> before, std::array<float, 2> u) const override {
    if (fault_ == Fault::sampling) u[0] *= 0.98f;
    PhaseSample s = inner_.sample(p, before, u);
    if (fault_ == Fault::weight) s.weight *= 1.02f;
    return s;
  }
  float meanCosine(std::span<const float> p) const override { return inner_.meanCosine(p); }

 private:
  const PhaseFunction& inner_;
  Fault fault_;
};

TEST(Phases, APlantedErrorOfTwoPercentIsCaught) {
  const Registry registry = allPlugins();
  const Parameters p{0.3f};
  for (const auto fault :
       {Planted::Fault::value, Planted::Fault::pdf, Planted::Fault::weight, Planted::Fault::sampling}) {
    Uniforms random(seedOfTest());
    EXPECT_FALSE(check(Planted(*registry.phase("henyey_greenstein"), fault), p, random)) << static_cast<int>(fault);
  }
  Uniforms random(seedOfTest());
  EXPECT_TRUE(check(Planted(*registry.phase("henyey_greenstein"), Planted::Fault::none), p, random));
}

}  // namespace
}  // namespace aerosol::render

// The phase function of Henyey and Greenstein (1941).
//
//   p(cos) = (1 - g²) / (4π (1 + g² - 2 g cos)^(3/2)),   g the mean cosine, cos between directions of travel.
//
// The textbook inversion divides by g and loses all digits as g → 0 or |g| → 1. With u = 2ξ - 1 the polynomials factor:
//   1 - cos = (1 - g)² (1 - u) (1 + (1 + u) g / 2) / (1 + g u)²
//   1 + cos = (1 + g)² (1 + u) (1 - (1 - u) g / 2) / (1 + g u)²
// in which nothing cancels, for every g in (-1, 1), 0 included. For the same reason the density takes
//   1 + g² - 2 g cos = (1 - |g|)² + 2 |g| (1 ∓ cos).

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/registry.h"
#include "core/volume/phase.h"

namespace aerosol::render {

namespace {

/// Above this |g| all light goes straight on (or back): the peak is narrower than what directions in float resolve.
constexpr double deltaLimit = 1 - 0x1p-20;

constexpr DescribedField hgFields[] = {{.name = "g",
                                        .unit = "",
                                        .minimum = -1,
                                        .maximum = 1,
                                        .doc = "Mean cosine of the deflection: positive scatters forward"}};

double anisotropy(std::span<const float> parameters) {
  return std::clamp(static_cast<double>(parameters[0]), -1.0, 1.0);
}

class HenyeyGreenstein final : public volume::PhaseFunction {
 public:
  std::string_view name() const override { return "henyey_greenstein"; }
  std::string_view doc() const override { return "A single lobe around the direction of travel"; }
  std::span<const DescribedField> fields() const override { return hgFields; }

  using PhaseFunction::evaluate;
  using PhaseFunction::pdf;

  float evaluate(std::span<const float> parameters, const volume::Deflection& deflection) const override {
    const double g = anisotropy(parameters), size = std::fabs(g);
    if (size >= deltaLimit) return 0;
    const double away = g > 0 ? deflection.oneMinusCosine : deflection.onePlusCosine;
    const double d = (1 - size) * (1 - size) + 2 * size * away;
    return static_cast<float>((1 - size) * (1 + size) / (4 * std::numbers::pi * d * std::sqrt(d)));
  }

  float pdf(std::span<const float> parameters, const volume::Deflection& deflection) const override {
    return evaluate(parameters, deflection);
  }

  volume::PhaseSample sample(std::span<const float> parameters, Vector<World> before,
                             std::array<float, 2> u) const override {
    const double g = anisotropy(parameters);
    if (std::fabs(g) >= deltaLimit) return {.direction = g > 0 ? before : -before, .pdf = 1, .isDelta = true};
    const double onePlusU = 2 * static_cast<double>(u[0]), oneMinusU = 2 * (1 - static_cast<double>(u[0]));
    const double denominator = g > 0 ? 1 - g + g * onePlusU : 1 + g - g * oneMinusU;
    const double a = (1 - g) / denominator, b = (1 + g) / denominator;
    const volume::Deflection deflection{a * a * oneMinusU * (1 + 0.5 * g * onePlusU),
                                        b * b * onePlusU * (1 - 0.5 * g * oneMinusU)};
    const double sine = std::sqrt(deflection.oneMinusCosine * deflection.onePlusCosine);
    const double phi = 2 * std::numbers::pi * static_cast<double>(u[1]);
    const Frame<World> frame(before);
    const Vector<World> after =
        frame.at(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
                 static_cast<float>(deflection.cosine()));
    return {.direction = normalize(after), .pdf = evaluate(parameters, deflection)};
  }

  float meanCosine(std::span<const float> parameters) const override {
    return static_cast<float>(anisotropy(parameters));
  }
};

}  // namespace

void registerPhase_henyey_greenstein(Registry& registry) { registry.add(std::make_unique<HenyeyGreenstein>()); }

}  // namespace aerosol::render

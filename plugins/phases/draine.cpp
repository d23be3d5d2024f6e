// The phase function of Draine (2003), "Scattering by interstellar dust grains", eq. 3.
//
//   p(cos) = HG(g, cos) (1 + α cos²) / (1 + α (1 + 2 g²) / 3)
//
// α = 0 is Henyey and Greenstein; g = 0, α = 1 is Rayleigh; g = 0.9, α ~ 20 has the backward peak of cloud droplets.
//
// Sampled through the lobe that it modulates: with ξ the share of a Henyey–Greenstein lobe up to some cosine, cos(ξ)
// its inverse, the distribution is
//   F(ξ) = (ξ + α ∫₀^ξ cos²) / (1 + α (1 + 2 g²) / 3),
// whose slope lies between 1 and 1 + α times a constant: safe Newton steps find the ξ for a random number. With
// v = 1 + g (2ξ - 1)
//   cos = ((1 + g²) - (1 - g²)² / v²) / (2 g),
// whose square has a closed integral in v; near g = 0, where that cancels, cos is smooth and Gauss–Legendre exact.

#include <algorithm>
#include <cmath>

#include "core/render/registry.h"
#include "core/volume/phase.h"
#include "plugins/phases/hg_lobe.h"

namespace aerosol::render {

namespace {

constexpr DescribedField draineFields[] = {{.name = "g",
                                            .unit = "",
                                            .minimum = -1,
                                            .maximum = 1,
                                            .doc = "Mean cosine of the lobe that is modulated: positive is forward"},
                                           {.name = "alpha",
                                            .unit = "",
                                            .minimum = 0,
                                            .maximum = 1000,
                                            .doc = "Strength of the modulation by 1 + alpha cos²"}};

struct Shape {
  double g, alpha;
  explicit Shape(std::span<const float> parameters)
      : g(std::clamp(static_cast<double>(parameters[0]), -1.0, 1.0)),
        alpha(std::clamp(static_cast<double>(parameters[1]), 0.0, 1000.0)) {}

  bool isDelta() const { return std::fabs(g) >= hg::deltaLimit; }
  /// 1 + α times the mean of cos² over the lobe.
  double norm() const { return 1 + alpha * (1 + 2 * g * g) / 3; }
};

/// ∫₀^ξ cos² over the lobe.
double integralOfSquare(double g, double xi) {
  if (std::fabs(g) < 0.1) {
    constexpr double nodes[] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                                0.9739065285171717};
    constexpr double weights[] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159821, 0.1494513491505806,
                                  0.0666713443086881};
    double sum = 0;
    for (std::size_t i = 0; i < std::size(nodes); ++i) {
      for (const double node : {-nodes[i], nodes[i]}) {
        const double at = 0.5 * xi * (1 + node);
        const double cosine = hg::deflectionAt(g, 2 * at, 2 * (1 - at)).cosine();
        sum += weights[i] * cosine * cosine;
      }
    }
    return 0.5 * xi * sum;
  }
  const double a = 1 + g * g, b = (1 - g * g) * (1 - g * g);
  const double v0 = 1 - g, v = 1 - g + 2 * g * xi;
  const auto primitive = [&](double x) { return a * a * x + 2 * a * b / x - b * b / (3 * x * x * x); };
  return (primitive(v) - primitive(v0)) / (8 * g * g * g);
}

/// The ξ at which F is `u`.
double invert(const Shape& shape, double u) {
  double low = 0, high = 1, xi = u;
  const double wanted = u * shape.norm();
  for (int i = 0; i < 100; ++i) {
    const double excess = xi + shape.alpha * integralOfSquare(shape.g, xi) - wanted;
    (excess > 0 ? high : low) = xi;
    const double cosine = hg::deflectionAt(shape.g, 2 * xi, 2 * (1 - xi)).cosine();
    double next = xi - excess / (1 + shape.alpha * cosine * cosine);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::fabs(next - xi) <= 1e-15 * xi) return next;
    xi = next;
  }
  return xi;
}

class Draine final : public volume::PhaseFunction {
 public:
  std::string_view name() const override { return "draine"; }
  std::string_view doc() const override { return "A lobe around the direction of travel with a peak backwards"; }
  std::span<const DescribedField> fields() const override { return draineFields; }

  using PhaseFunction::evaluate;
  using PhaseFunction::pdf;

  float evaluate(std::span<const float> parameters, const volume::Deflection& deflection) const override {
    const Shape shape(parameters);
    if (shape.isDelta()) return 0;
    const double cosine = deflection.cosine();
    return static_cast<float>(hg::density(shape.g, deflection) * (1 + shape.alpha * cosine * cosine) / shape.norm());
  }

  float pdf(std::span<const float> parameters, const volume::Deflection& deflection) const override {
    return evaluate(parameters, deflection);
  }

  volume::PhaseSample sample(std::span<const float> parameters, Vector<World> before,
                             std::array<float, 2> u) const override {
    const Shape shape(parameters);
    if (shape.isDelta()) return {.direction = shape.g > 0 ? before : -before, .pdf = 1, .isDelta = true};
    // The distribution from the other end is that of -g: there small shares keep their digits.
    const bool isForward = u[0] > 0.5f;
    Shape from = shape;
    if (isForward) from.g = -shape.g;
    const double share = isForward ? 1 - static_cast<double>(u[0]) : static_cast<double>(u[0]);
    const double xi = invert(from, share);
    volume::Deflection deflection = hg::deflectionAt(from.g, 2 * xi, 2 * (1 - xi));
    if (isForward) std::swap(deflection.oneMinusCosine, deflection.onePlusCosine);
    return {.direction = hg::turned(before, deflection, u[1]), .pdf = evaluate(parameters, deflection)};
  }

  /// With E[cos] = g and E[cos³] = (2 g³ + 3 g) / 5 over the lobe.
  float meanCosine(std::span<const float> parameters) const override {
    const Shape shape(parameters);
    if (shape.isDelta()) return static_cast<float>(shape.g);
    const double g = shape.g;
    return static_cast<float>((g + shape.alpha * g * (3 + 2 * g * g) / 5) / shape.norm());
  }
};

}  // namespace

void registerPhase_draine(Registry& registry) { registry.add(std::make_unique<Draine>()); }

}  // namespace aerosol::render

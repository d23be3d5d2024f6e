// The phase function of Henyey and Greenstein (1941).

#include <algorithm>
#include <cmath>

#include "core/render/registry.h"
#include "core/volume/phase.h"
#include "plugins/phases/hg_lobe.h"

namespace aerosol::render {

namespace {

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
    const double g = anisotropy(parameters);
    return std::fabs(g) >= hg::deltaLimit ? 0.0f : static_cast<float>(hg::density(g, deflection));
  }

  float pdf(std::span<const float> parameters, const volume::Deflection& deflection) const override {
    return evaluate(parameters, deflection);
  }

  volume::PhaseSample sample(std::span<const float> parameters, Vector<World> before,
                             std::array<float, 2> u) const override {
    const double g = anisotropy(parameters);
    if (std::fabs(g) >= hg::deltaLimit) return {.direction = g > 0 ? before : -before, .pdf = 1, .isDelta = true};
    const volume::Deflection deflection =
        hg::deflectionAt(g, 2 * static_cast<double>(u[0]), 2 * (1 - static_cast<double>(u[0])));
    return {.direction = hg::turned(before, deflection, u[1]), .pdf = evaluate(parameters, deflection)};
  }

  float meanCosine(std::span<const float> parameters) const override {
    return static_cast<float>(anisotropy(parameters));
  }
};

}  // namespace

void registerPhase_henyey_greenstein(Registry& registry) { registry.add(std::make_unique<HenyeyGreenstein>()); }

}  // namespace aerosol::render

// Mie scattering by water droplets: Jendersie and d'Eon, "An Approximate Mie Scattering Function for Fog and Cloud
// Rendering" (2023). For a droplet of diameter d the phase function is a mean of a Henyey–Greenstein lobe (the
// diffraction peak) and one of Draine's (the rest, with the glow backwards): (1 - w) HG(g1) + w D(g2, α), with the four
// numbers fitted over ranges of d.

#include "core/render/medium_phase.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/volume/blended_phase.h"
#include "core/volume/phase_mixture.h"
#include "core/volume/tabulated_phase.h"

namespace aerosol::render {

namespace {

using volume::PhaseMixture;
using Parts = std::vector<PhaseMixture::Part>;

/// A function of the registry outlives what refers to it.
std::shared_ptr<const volume::PhaseFunction> registered(const Registry& registry, const char* name) {
  return {std::shared_ptr<const volume::PhaseFunction>(), registry.phase(name)};
}

struct MieFit {
  double hgG = 0, draineG = 0, draineAlpha = 0, draineShare = 0;
};

MieFit fitMie(double d) {
  const double l = std::log(d);
  if (d <= 0.1) return {13.8 * d * d, 1.1456 * d * std::sin(9.29044 * d), 250, 0.252977 - 312.983 * std::pow(d, 4.3)};
  if (d < 1.5) {
    const double inner = std::cos((l - 0.238604) * (l + 1.00667) / (0.507522 - 0.15677 * l));
    return {0.862 - 0.143 * l * l, 0.379685 * std::cos(1.19692 * inner + 1.37932 * l + 0.0625835) + 0.344213, 250,
            0.146209 * std::cos(3.38707 * l + 2.11193) + 0.316072 + 0.0778917 * l};
  }
  if (d < 5)
    return {0.0604931 * std::log(l) + 0.940256, 0.500411 - 0.081287 / (-2 * l + std::tan(l) + 1.27551),
            7.30354 * l + 6.31675, 0.026914 * (l - std::cos(5.68947 * (std::log(l) - 0.0292149))) + 0.376475};
  return {std::exp(-0.0990567 / (d - 1.67154)), std::exp(-2.20679 / (d + 3.91029) - 0.428934),
          std::exp(3.62489 - 8.29288 / (d + 5.52825)), std::exp(-0.599085 / (d - 0.641583) - 0.665888)};
}

void add(Parts& parts, float share, std::shared_ptr<const volume::PhaseFunction> function,
         std::vector<float> parameters = {}) {
  if (share > 0) parts.push_back({share, std::move(function), std::move(parameters)});
}

void addMie(Parts& parts, const scene::Phase& phase, const Registry& registry) {
  const MieFit fit = fitMie(static_cast<double>(phase.particleDiameter_um));
  const auto share = static_cast<float>(std::clamp(fit.draineShare, 0.0, 1.0));
  add(parts, 1 - share, registered(registry, "henyey_greenstein"), {static_cast<float>(fit.hgG)});
  add(parts, share, registered(registry, "draine"),
      {static_cast<float>(fit.draineG), static_cast<float>(fit.draineAlpha)});
}

}  // namespace

std::shared_ptr<const volume::PhaseFunction> makePhase(const scene::Phase& phase, const Registry& registry) {
  using enum scene::PhaseType;
  Parts parts;
  switch (phase.type) {
    case hg:
    case isotropic:
      add(parts, 1, registered(registry, "henyey_greenstein"), {phase.g});
      break;
    case rayleigh:
      add(parts, 1, registered(registry, "draine"), {0, 1});
      break;
    case draine:
      add(parts, 1, registered(registry, "draine"), {phase.g, phase.alpha});
      break;
    case mie:
      addMie(parts, phase, registry);
      break;
    case tabphase:
      return std::make_shared<volume::TabulatedPhase>(phase.values);
    case blendphase:
      if (phase.isWeightFed) {
        return std::make_shared<volume::BlendedPhase>(makePhase(phase.parts[0], registry),
                                                      makePhase(phase.parts[1], registry));
      }
      add(parts, 1 - phase.weight, makePhase(phase.parts[0], registry));
      add(parts, phase.weight, makePhase(phase.parts[1], registry));
      break;
  }
  return std::make_shared<PhaseMixture>(std::move(parts));
}

}  // namespace aerosol::render

// What a distance tracker returns, in the general form of the talk: a distance and its pdf, or "passed" and its
// probability.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/volume/medium.h"

namespace aerosol::volume {

/// What a tracker's pdf is.
enum class PdfKind : std::uint8_t {
  marginal,  ///< Density of the distance alone.
  joint,     ///< Density of the distance together with the null collisions before it.
};

enum class DistanceEvent : std::uint8_t { passed, scattered, absorbed };

/// One outcome of sampling a distance in a segment.
///   scattered: weight = σs(t) T(t) / pdf, with the lobe's own σs and its selection probability;
///   passed:    weight = T(t1) / P, P the probability of passing;
///   absorbed:  weight = 0.
struct DistanceSample {
  DistanceEvent event = DistanceEvent::passed;
  PdfKind pdfKind = PdfKind::marginal;
  double t = 0;                    ///< Along the ray, when scattered.
  double logPdf = 0;               ///< Natural logarithm of the pdf (per scene unit) or of P.
  Color weight{1.0f};              ///< No unit.
  Color emission;                  ///< Radiance met on the way, for unit throughput at the segment's start.
  const Medium* medium = nullptr;  ///< That scattered.
  float anisotropy = 0;            ///< Of the lobe that scattered.

  double pdf() const { return std::exp(logPdf); }
};

/// Coefficients of all media of a segment at one point.
struct CoefficientSum {
  Color sigmaT, sigmaS, emission;

  void add(const Coefficients& c) {
    sigmaT += c.sigmaT;
    sigmaS += c.sigmaS;
    emission += c.emission;
  }
};

/// Chooses a scattering lobe in proportion to the mean of its σs. `forEach(use)` calls use(medium, coefficients) for
/// every medium at the point; it is run twice. Writes the lobe into `sample`: the weight becomes `weight` · σs(lobe) /
/// P(lobe), where `weight` is T / pdf without σs. Absorbed where nothing scatters. `u` in [0, 1).
template <class ForEach>
void chooseLobe(const ForEach& forEach, Color weight, float u, DistanceSample& sample) {
  float total = 0;
  forEach([&](const Medium&, const Coefficients& part) {
    for (std::uint32_t k = 0; k < part.lobeCount; ++k) total += average(abs(part.lobes[k].sigmaS));
  });
  sample.event = DistanceEvent::absorbed;
  sample.weight = Color();
  if (!(total > 0)) return;
  float remaining = u * total;
  bool isChosen = false;
  forEach([&](const Medium& medium, const Coefficients& part) {
    for (std::uint32_t k = 0; k < part.lobeCount && !isChosen; ++k) {
      const Lobe& lobe = part.lobes[k];
      const float share = average(abs(lobe.sigmaS));
      if (share <= 0) continue;
      // Rounding may leave a remainder after the last lobe; the last one with a share stays chosen.
      sample.event = DistanceEvent::scattered;
      sample.medium = &medium;
      sample.anisotropy = lobe.anisotropy;
      sample.weight = weight * lobe.sigmaS * (total / share);
      isChosen = remaining < share;
      remaining -= share;
    }
  });
}

}  // namespace aerosol::volume

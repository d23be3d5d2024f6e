// What a distance tracker returns, in the general form of the talk: a distance and its pdf, or "passed" and its
// probability.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/volume/few_or_many.h"
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

/// Chooses a scattering lobe in proportion to the mean of its σs. Of one point, medium by medium: `add` all, then
/// `choose`.
class LobeChoice {
 public:
  void add(const Medium& medium, const Coefficients& part) { parts_.push_back({&medium, &part}); }

  /// Writes the lobe into `sample`: the weight becomes `weight` · σs(lobe) / P(lobe), where `weight` is T / pdf without
  /// σs. Absorbed where nothing scatters. `u` in [0, 1).
  void choose(Color weight, float u, DistanceSample& sample) const;

 private:
  struct Part {
    const Medium* medium = nullptr;
    const Coefficients* coefficients = nullptr;
  };
  FewOrMany<Part, 4> parts_;
};

}  // namespace aerosol::volume

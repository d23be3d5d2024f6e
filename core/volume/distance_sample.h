// What a distance tracker returns, in the general form of the talk: a distance and its pdf, or "passed" and its
// probability.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/volume/medium.h"
#include "core/volume/segments.h"

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
///
/// `choicePdf` is what other ways to choose a distance are compared with (Miller, Georgiev and Jarosz 2019, "A
/// Null-Scattering Path Integral Formulation of Light Transport"): the density of t given all that a tracker draws
/// besides, which is its cells or its tentative collisions. Of a closed form it is the pdf itself. A chain of null
/// collisions z₁ … zₙ has the density Π μ̄(zᵢ) P(zᵢ null) · μ̄(t) P(t real) · exp(-∫ μ̄); for a t that something else
/// chose the same chain in front of it has Π μ̄(zᵢ) exp(-∫ μ̄) alone. What is left of the quotient is Π P(zᵢ null) · μ̄(t)
/// P(t real).
struct DistanceSample {
  DistanceEvent event = DistanceEvent::passed;
  PdfKind pdfKind = PdfKind::marginal;
  double t = 0;                    ///< Along the ray, when scattered.
  double logPdf = 0;               ///< Natural logarithm of the pdf (per scene unit) or of P.
  double choicePdf = 1;            ///< See below: per scene unit when scattered, else a probability.
  Color weight{1.0f};              ///< No unit.
  Color emission;                  ///< Radiance met on the way, for unit throughput at the segment's start.
  const Medium* medium = nullptr;  ///< That scattered.
  float anisotropy = 0;            ///< Of the lobe that scattered.
  double lightScale = 0;           ///< What the place is to tabulated lights, when scattered; see TabulatedLight.

  double pdf() const { return std::exp(logPdf); }
};

struct TabulatedLight;

/// A distance that something else than a tracker chose, and what trackers find there: `sample` passes segment by
/// segment with weight = T and choicePdf = P(the tracker passes), until at `t` it is scattered with weight = σs T of a
/// lobe over that lobe's probability, or absorbed. The weight is not divided by any density of t.
struct GivenDistance {
  double t = 0;
  DistanceSample sample;
  TabulatedLight* lights = nullptr;  ///< With it `t` is infinite: marching looks for a place by itself.

  bool isOpen() const { return sample.event == DistanceEvent::passed; }
  /// Is anything to be found in or behind this segment?
  bool concerns(const Segment& segment) const { return isOpen() && t >= segment.t0; }
  bool isIn(const Segment& segment) const { return t >= segment.t0 && t < segment.t1; }
  void pass(Color transmittance, double probability) {
    sample.weight *= transmittance;
    sample.choicePdf *= probability;
  }
  void end() {
    sample.event = DistanceEvent::absorbed;
    sample.weight = Color();
  }
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

/// Chooses a scattering lobe in proportion to the mean of its σs. `forEach(use)` calls use(medium, lobe) for every lobe
/// at the point; it is run twice. Writes the lobe into `sample`: the weight becomes `weight` · σs(lobe) / P(lobe),
/// where `weight` is T / pdf without σs. Absorbed where nothing scatters. `u` in [0, 1).
template <class ForEach>
void chooseAmongLobes(const ForEach& forEach, Color weight, float u, DistanceSample& sample) {
  float total = 0;
  forEach([&](const Medium&, const Lobe& lobe) { total += average(abs(lobe.sigmaS)); });
  sample.event = DistanceEvent::absorbed;
  sample.weight = Color();
  if (!(total > 0)) return;
  float remaining = u * total;
  bool isChosen = false;
  forEach([&](const Medium& medium, const Lobe& lobe) {
    const float share = average(abs(lobe.sigmaS));
    if (isChosen || share <= 0) return;
    // Rounding may leave a remainder after the last lobe; the last one with a share stays chosen.
    sample.event = DistanceEvent::scattered;
    sample.medium = &medium;
    sample.anisotropy = lobe.anisotropy;
    sample.weight = weight * lobe.sigmaS * (total / share);
    isChosen = remaining < share;
    remaining -= share;
  });
}

/// The same, where `forEach(use)` calls use(medium, coefficients) for every medium at the point.
template <class ForEach>
void chooseLobe(const ForEach& forEach, Color weight, float u, DistanceSample& sample) {
  const auto forEachLobe = [&](auto&& use) {
    forEach([&](const Medium& medium, const Coefficients& part) {
      for (std::uint32_t k = 0; k < part.lobeCount; ++k) use(medium, part.lobes[k]);
    });
  };
  chooseAmongLobes(forEachLobe, weight, u, sample);
}

}  // namespace aerosol::volume

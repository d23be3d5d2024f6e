// Null scattering: delta tracking for distances, ratio tracking for transmittance.
//
// Woodcock et al. 1965; Galtier et al. 2013; Novák et al. 2014 (ratio tracking); Kutz et al. 2017 (spectral tracking,
// eq. 25–27): tentative collisions come at the rate of the bound μ̄; each is a scattering or a null collision with
// probabilities in proportion to |w σs| and |w σn|, w the path's throughput including the weights gathered here and
// σn = μ̄ − σt. Absorption is never a random event: it stays in the weights. Where extinction exceeds the bound, σn is
// negative and so is the weight: the mean stays right as long as the bound is positive, and the excess is counted.
#pragma once

#include "core/volume/distance_sample.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// The bound in force for a medium: its bound, relaxed to 1 / step where asked (talk: "relaxing to max(μ̄,
/// 1/stepsize)"). A bound of 0 is never taken at its word: emission, and extinction that should not be there, are still
/// looked for once a step.
inline float workingBound(const Medium& medium) {
  if (medium.constant) return maximum(medium.constant->sigmaT);
  const float bound = medium.bound->value;
  return medium.relaxesBound || !(bound > negligibleExtinction) ? std::max(bound, 1.0f / medium.stepSize) : bound;
}

inline void countViolation(const Medium& medium, Color sigmaT, float bound, TrackerStatistics& statistics) {
  const float largest = maximum(sigmaT);
  if (!(largest > bound * 1.00001f)) return;
  ++statistics.boundViolations;
  if (largest > statistics.worstViolation * bound) {
    statistics.worstViolation = largest / bound;
    statistics.worstMedium = medium.index;
  }
}

/// Free flight at rate `bound`. 1 - u is exact: u has 24 bits.
inline float freeFlight(float u, float bound) { return -std::log(1 - u) / bound; }

/// The logarithm of a product of many positive factors, at the price of one logarithm: the exponents are added up.
class LogProduct {
 public:
  void multiply(float factor) {
    product_ *= static_cast<double>(factor);
    if (product_ < 0x1p-900 || product_ > 0x1p900) [[unlikely]]
      rescale();
  }
  double logarithm() const { return std::log(product_) + exponent_ * 0.69314718055994530942; }

 private:
  void rescale() {
    int exponent = 0;
    product_ = std::frexp(product_, &exponent);
    exponent_ += exponent;
  }
  double product_ = 1;
  double exponent_ = 0;
};

/// A weight below this share of the incoming throughput plays Russian roulette inside a tracker.
inline constexpr float trackerRouletteThreshold = 0.05f;

/// Samples a distance in a segment. Every medium needs a bound or constant coefficients. The pdf is joint with the
/// chain.
template <Evaluator E, UniformSource R>
Task<DistanceSample> sampleByNullScattering(E& evaluator, Ray<World> ray, Segment segment, Color throughput,
                                            R& random) {
  DistanceSample sample;
  sample.pdfKind = PdfKind::joint;
  float bound = 0;
  for (const Medium* medium : segment.media) bound += workingBound(*medium);
  if (!(bound > negligibleExtinction)) co_return sample;
  const ChannelMixture channels(throughput);

  // Of the chain up to t: exp(-μ̄ (t - t0)) times μ̄ and the probability of what happened, for each collision.
  LogProduct choices;
  const auto logPdfUpTo = [&](double end) {
    return choices.logarithm() - static_cast<double>(bound) * (end - static_cast<double>(segment.t0));
  };
  Color weight(1.0f);
  double t = segment.t0;  // Far out, flights are shorter than float can add.
  for (int step = 0;; ++step) {
    t += freeFlight(random.next(), bound);
    if (!(t < segment.t1)) {
      sample.logPdf = logPdfUpTo(segment.t1);
      sample.weight = weight;
      co_return sample;
    }
    if (step == maximumSteps) {
      ++evaluator.trackerStatistics().stepLimits;
      sample.weight = weight;
      co_return sample;
    }

    askSegment(evaluator, segment.media, ray.at(static_cast<float>(t)));
    const std::span<const Coefficients> answers = co_await evaluator.answers();
    CoefficientSum sum;
    std::size_t next = 0;
    for (const Medium* medium : segment.media) {
      const Coefficients& c = coefficientsOf(*medium, answers, next);
      if (!medium->constant) countViolation(*medium, c.sigmaT, workingBound(*medium), evaluator.trackerStatistics());
      sum.add(c);
    }
    sample.emission += weight * sum.emission / bound;

    const Color sigmaN = Color(bound) - sum.sigmaT;
    const float scatter = channels.mix(abs(weight * sum.sigmaS));
    const float pass = channels.mix(abs(weight * sigmaN));
    if (!(scatter + pass > 0)) {
      sample.event = DistanceEvent::absorbed;
      sample.weight = Color();
      co_return sample;
    }
    const float scatterProbability = scatter / (scatter + pass);
    if (random.next() < scatterProbability) {
      sample.t = static_cast<float>(t);
      choices.multiply(bound * scatterProbability);
      sample.logPdf = logPdfUpTo(t);
      chooseLobe(segment.media, answers, weight / (bound * scatterProbability), random.next(), sample);
      co_return sample;
    }
    const float nullProbability = 1 - scatterProbability;
    choices.multiply(bound * nullProbability);
    weight *= sigmaN / (bound * nullProbability);

    const float size = channels.mix(abs(weight));
    if (size < trackerRouletteThreshold) {
      const float survival = std::max(size / trackerRouletteThreshold, 0.1f);
      if (!(random.next() < survival)) {
        sample.event = DistanceEvent::absorbed;
        sample.weight = Color();
        co_return sample;
      }
      weight = weight / survival;
    }
  }
}

/// Transmittance of one medium over [t0, t1] by ratio tracking: unbiased, signed where the bound is exceeded.
template <Evaluator E, UniformSource R>
Task<Color> ratioTracking(E& evaluator, Ray<World> ray, MediumSpan span, R& random) {
  const float bound = workingBound(*span.medium);
  Color transmittance(1.0f);
  if (!(bound > negligibleExtinction)) co_return transmittance;
  double t = span.t0;
  for (int step = 0;; ++step) {
    t += freeFlight(random.next(), bound);
    if (!(t < span.t1)) co_return transmittance;
    if (step == maximumSteps) {
      ++evaluator.trackerStatistics().stepLimits;
      co_return transmittance;
    }
    evaluator.ask(*span.medium, ray.at(static_cast<float>(t)), Quantity::extinction);
    const Color sigmaT = (co_await evaluator.answers())[0].sigmaT;
    countViolation(*span.medium, sigmaT, bound, evaluator.trackerStatistics());
    transmittance *= Color(1.0f) - sigmaT / bound;

    const float size = maximum(abs(transmittance));
    if (size == 0) co_return Color();
    if (size < trackerRouletteThreshold) {
      const float survival = std::max(size / trackerRouletteThreshold, 0.1f);
      if (!(random.next() < survival)) co_return Color();
      transmittance = transmittance / survival;
    }
  }
}

}  // namespace aerosol::volume

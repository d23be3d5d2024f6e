// Null scattering: delta tracking for distances, ratio tracking for transmittance.
//
// Woodcock et al. 1965; Galtier et al. 2013; Novák et al. 2014 (ratio tracking); Kutz et al. 2017 (spectral tracking,
// eq. 25–27): tentative collisions come at the rate of the bound μ̄; each is a scattering or a null collision with
// probabilities in proportion to |w σs| and |w σn|, w the path's throughput including the weights gathered here and
// σn = μ̄ − σt. Absorption is never a random event: it stays in the weights. Where extinction exceeds the bound, σn is
// negative and so is the weight: the mean stays right as long as the bound is positive, and the excess is counted.
//
// The bound is piecewise constant along the ray, leaf by leaf of the media's trees (Szirmay-Kalos et al. 2011): one
// exponential number is used up by the optical distances ∫ μ̄ of the leaves, so nothing is drawn anew at their faces.
// Where all coefficients of a leaf are known nobody is asked.
#pragma once

#include "core/volume/distance_sample.h"
#include "core/volume/segment_walk.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

inline void countViolation(const Medium& medium, const BoundNode& leaf, Color sigmaT, TrackerStatistics& statistics) {
  const float largest = maximum(sigmaT);
  const float limit = std::max(leaf.limit, medium.relaxesBound ? 1.0f / medium.stepSize : 0.0f);
  if (!(largest > limit * 1.00001f)) return;
  ++statistics.boundViolations;
  if (largest > statistics.worstViolation * limit) {
    statistics.worstViolation = largest / limit;
    statistics.worstMedium = medium.index;
    statistics.worstExtinction = largest;
  }
}

/// An optical distance with density exp(-x). 1 - u is exact: u has 24 bits.
inline float freeFlight(float u) { return -std::log(1 - u); }

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

/// Russian roulette for a weight of which `size` is left. False where it ends; otherwise `weight` is raised to the
/// threshold.
template <UniformSource R>
bool survivesTrackerRoulette(Color& weight, float size, R& random) {
  if (size >= trackerRouletteThreshold) return true;
  if (!(random.next() * trackerRouletteThreshold < size)) return false;
  weight = weight * (trackerRouletteThreshold / size);
  return true;
}

/// The way from one tentative collision to the next through the stretches of a segment.
class TentativeFlight {
 public:
  TentativeFlight(const Segment& segment, const Ray<World>& ray, FrameStack& memory)
      : walk_(segment, ray, memory), t_(segment.t0) {}

  /// Flies on by an optical distance. False when the segment's end comes first. `emission` takes the light of known
  /// media on the way, for unit weight: on each stretch its expected value over all flights, ∫ ε exp(-μ̄ s) ds.
  bool advance(double opticalDistance, Color& emission) {
    for (;;) {
      const auto rate = static_cast<double>(walk_.rate());
      const double length = walk_.end() > t_ ? walk_.end() - t_ : 0;
      if (!isBlack(walk_.known().emission)) {
        emission += walk_.known().emission * transmittedLength(walk_.rate(), static_cast<float>(length));
      }
      const double depth = rate > 0 ? rate * length : 0;
      if (opticalDistance < depth) {
        t_ = std::min(t_ + opticalDistance / rate, walk_.end());
        depth_ += opticalDistance;
        return true;
      }
      opticalDistance -= depth;
      depth_ += depth;
      t_ = walk_.end();
      if (walk_.isLast()) return false;
      walk_.next();
    }
  }

  double t() const { return t_; }
  const SegmentWalk& walk() const { return walk_; }
  /// ∫ μ̄ from the segment's start.
  double depth() const { return depth_; }

 private:
  SegmentWalk walk_;
  double t_;
  double depth_ = 0;
};

/// Samples a distance in a segment. Every medium needs a tree, a bound or constant coefficients. The pdf is joint with
/// the chain.
template <Evaluator E, UniformSource R>
Task<DistanceSample> sampleByNullScattering(E& evaluator, Ray<World> ray, Segment segment, Color throughput,
                                            R& random) {
  DistanceSample sample;
  sample.pdfKind = PdfKind::joint;
  const ChannelMixture channels(throughput);
  TentativeFlight flight(segment, ray, evaluator.frames());
  LogProduct choices;  // Of the chain: μ̄ and the probability of what happened, for each collision.
  Color weight(1.0f);
  for (int step = 0;; ++step) {
    Color emission;
    const bool collides = flight.advance(static_cast<double>(freeFlight(random.next())), emission);
    sample.emission += weight * emission;
    if (!collides || step == maximumSteps) {
      evaluator.trackerStatistics().stepLimits += collides;
      sample.logPdf = choices.logarithm() - flight.depth();
      sample.weight = weight;
      co_return sample;
    }

    const SegmentWalk& walk = flight.walk();
    walk.ask(evaluator, pointOn(ray, flight.t()));
    const std::span<const Coefficients> answers = co_await evaluator.answers();
    CoefficientSum sum = walk.known();
    const float bound = walk.rate();
    walk.forAnswers(answers, [&](const Medium& medium, const BoundNode& leaf, const Coefficients& c) {
      countViolation(medium, leaf, c.sigmaT, evaluator.trackerStatistics());
      sum.sigmaT += c.sigmaT;
      sum.sigmaS += c.sigmaS;
      sample.emission += weight * c.emission / bound;
    });

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
      sample.t = flight.t();
      choices.multiply(bound * scatterProbability);
      sample.logPdf = choices.logarithm() - flight.depth();
      walk.chooseLobe(answers, weight / (bound * scatterProbability), random.next(), sample);
      co_return sample;
    }
    const float nullProbability = 1 - scatterProbability;
    choices.multiply(bound * nullProbability);
    weight *= sigmaN / (bound * nullProbability);

    if (!survivesTrackerRoulette(weight, channels.mix(abs(weight)), random)) {
      sample.event = DistanceEvent::absorbed;
      sample.weight = Color();
      co_return sample;
    }
  }
}

/// Transmittance of one medium over [t0, t1] by residual ratio tracking (Novák et al. 2014): in each leaf the least
/// extinction is a control, taken in closed form, and collisions come at the rate of the rest of the bound. Unbiased,
/// signed where the bound is exceeded.
template <Evaluator E, UniformSource R>
Task<Color> ratioTracking(E& evaluator, Ray<World> ray, MediumSpan span, R& random) {
  const Medium& medium = *span.medium;
  BoundWalk walk(medium, ray, span.t0);
  Color transmittance(1.0f);
  if (!(span.t0 < span.t1)) co_return transmittance;
  double t = span.t0;
  auto flight = static_cast<double>(freeFlight(random.next()));
  int step = 0;
  for (;; walk.next()) {
    const double end = std::min(walk.end(), span.t1);
    if (const Coefficients* known = walk.known(); known && walk.leaf().majorant == 0) {
      // Nothing here.
    } else if (known) {
      transmittance *= exp(opticalDepth(known->sigmaT, static_cast<float>(end - t)) * -1.0f);
      if (!survivesTrackerRoulette(transmittance, maximum(abs(transmittance)), random)) co_return Color();
    } else {
      const BoundNode leaf = walk.leaf();
      if (leaf.control > 0) transmittance *= std::exp(-opticalDepth(leaf.control, static_cast<float>(end - t)));
      const float bound = medium.collisionRate(leaf) - leaf.control;
      const auto depthAt = [&](double from) {
        return bound > negligibleExtinction ? static_cast<double>(bound) * (end - from) : 0;
      };
      for (; flight < depthAt(t); flight = static_cast<double>(freeFlight(random.next()))) {
        if (step++ == maximumSteps) {
          ++evaluator.trackerStatistics().stepLimits;
          co_return transmittance;
        }
        t = std::min(t + flight / static_cast<double>(bound), end);
        evaluator.ask(medium, pointOn(ray, t), Quantity::extinction);
        const Color sigmaT = (co_await evaluator.answers())[0].sigmaT;
        countViolation(medium, leaf, sigmaT, evaluator.trackerStatistics());
        transmittance *= Color(1.0f) - (sigmaT - Color(leaf.control)) / bound;
        if (!survivesTrackerRoulette(transmittance, maximum(abs(transmittance)), random)) co_return Color();
      }
      flight -= depthAt(t);
    }
    if (end >= span.t1) co_return transmittance;
    t = end;
  }
}

}  // namespace aerosol::volume

// Null scattering: delta tracking for distances, ratio tracking for transmittance.
//
// Woodcock et al. 1965; Galtier et al. 2013; Novák et al. 2014 (ratio tracking); Kutz et al. 2017 (spectral tracking,
// eq. 25–27): tentative collisions come at the rate of the bound μ̄; each is a scattering or a null collision with
// probabilities in proportion to |w σs| and |w σn|, w the path's throughput including the weights gathered here and
// σn = μ̄ − σt. Absorption stays in the weights, except in analogue media, where it is a third event with a probability
// in proportion to |w σa|. Where extinction exceeds the bound, σn is negative and so is the weight: the mean stays
// right as long as the bound is positive, and the excess is counted.
//
// The bound is piecewise constant along the ray, leaf by leaf of the media's trees (Szirmay-Kalos et al. 2011): one
// exponential number is used up by the optical distances ∫ μ̄ of the leaves, so nothing is drawn anew at their faces.
// Where all coefficients of a leaf are known nobody is asked.
//
// Emission that varies is met by the tentative collisions, w ε / μ̄ at each, or along the line: at points of a jittered
// comb, w ε times their distance. Its mean over all flights is the transmittance, so both are unbiased; but collisions
// come at random, and where extinction is small seldom, while the places of the comb are even. Collisions take its part
// where they come several times as often. The light's w is that of ratio tracking, Π σn/μ̄: it does not depend on
// whether any of the collisions was a real one, and goes on behind it.
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

/// Places at equal steps along a ray, the first one a random part of a step from its start.
class EmissionComb {
 public:
  static constexpr double never = std::numeric_limits<double>::infinity();

  void begin(double t0, double step, double offset) {
    start_ = t0 + offset * step;
    step_ = step;
    next_ = 0;
  }
  void end() { step_ = never; }
  bool isOn() const { return step_ < never; }
  double step() const { return step_; }
  /// The first place from `t` on that was not taken.
  double from(double t) {
    next_ = std::max(next_, std::ceil((t - start_) / step_));
    return start_ + next_ * step_;
  }
  void take() { ++next_; }

 private:
  double start_ = 0, step_ = never, next_ = 0;
};

/// The way from one tentative collision to the next through the stretches of a segment.
class TentativeFlight {
 public:
  enum class Arrival : std::uint8_t { collision, stop, light, end };

  TentativeFlight(const Segment& segment, const Ray<World>& ray, FrameStack& memory)
      : walk_(segment, ray, memory), t_(segment.t0) {}

  /// Arrives at the places of the comb as well, on stretches where emission is to be looked for.
  EmissionComb& comb() { return comb_; }

  /// Starts the next flight over an optical distance.
  void launch(double opticalDistance) {
    left_ = opticalDistance;
    isAtStart_ = true;
  }

  /// Flies on until the flight's length is used up, the segment ends, or `stop` is reached, from where the same flight
  /// goes on with the next call; likewise at a place of the comb (`light`). `emission` takes the light of known media
  /// on the way, for unit weight: on each stretch its expected value over all flights, ∫ ε exp(-μ̄ s) ds.
  Arrival advance(double stop, Color& emission) {
    for (;;) {
      const auto rate = static_cast<double>(walk_.rate());
      const double length = walk_.end() > t_ ? walk_.end() - t_ : 0;
      if (isAtStart_ && !isBlack(walk_.known().emission)) {
        emission += walk_.known().emission * transmittedLength(walk_.rate(), static_cast<float>(length));
      }
      isAtStart_ = false;
      const double depth = rate > 0 ? rate * length : 0;
      const double light = placeOfComb();
      const double halt = std::min(stop, light);
      const double collision = left_ < depth ? std::min(t_ + left_ / rate, walk_.end()) : walk_.end();
      if (halt < collision || (halt <= collision && left_ < depth)) {
        const double part = rate > 0 ? rate * std::max(halt - t_, 0.0) : 0;
        left_ = std::max(left_ - part, 0.0);
        depth_ += part;
        t_ = std::max(t_, halt);
        if (stop <= light) return Arrival::stop;
        comb_.take();
        return Arrival::light;
      }
      t_ = collision;
      if (left_ < depth) {
        depth_ += left_;
        return Arrival::collision;
      }
      left_ -= depth;
      depth_ += depth;
      if (walk_.isLast()) return Arrival::end;
      walk_.next();
      isAtStart_ = true;
    }
  }

  double t() const { return t_; }
  const SegmentWalk& walk() const { return walk_; }
  /// ∫ μ̄ from the segment's start.
  double depth() const { return depth_; }

 private:
  double placeOfComb() {
    if (!comb_.isOn() || !(walk_.emissionStep() < std::numeric_limits<float>::infinity())) return EmissionComb::never;
    const double place = comb_.from(t_);
    return place < walk_.end() ? place : EmissionComb::never;
  }

  SegmentWalk walk_;
  EmissionComb comb_;
  double t_;
  double left_ = 0;
  double depth_ = 0;
  bool isAtStart_ = true;
};

/// At which emission is looked for in a segment; infinite where none of its media does so.
inline float emissionStepOf(const Segment& segment) {
  float step = std::numeric_limits<float>::infinity();
  for (const Medium* medium : segment.media) {
    if (medium->integratesEmission && !medium->constant) step = std::min(step, medium->stepSize);
  }
  return step;
}

/// What may happen at a place under the bound μ̄, for light of some weight.
struct CollisionOdds {
  Color sigmaN;  ///< μ̄ − σt.
  float scatter = 0, pass = 0, absorb = 0;

  CollisionOdds(const CoefficientSum& sum, float bound, Color weight, const ChannelMixture& channels, bool isAnalogue)
      : sigmaN(Color(bound) - sum.sigmaT),
        scatter(channels.mix(abs(weight * sum.sigmaS))),
        pass(channels.mix(abs(weight * sigmaN))) {
    if (isAnalogue) absorb = channels.mix(abs(weight * (sum.sigmaT - sum.sigmaS)));
  }
  bool areNone() const { return !(scatter + pass > 0); }
  /// These depend on the proportions of the weight alone: roulette and the chances of earlier collisions cancel.
  float scatterProbability() const { return scatter / (scatter + pass + absorb); }
  float passProbability() const {
    return absorb > 0 ? pass / (scatter + pass + absorb) : 1 - scatter / (scatter + pass);
  }
};

/// Samples a distance in a segment, unless `tracks` is false. Every medium needs a tree, a bound or constant
/// coefficients. The pdf is joint with the chain. What lies at a `given` distance is found on the same way: behind the
/// real collision the chain of tentative ones goes on for it alone.
template <Evaluator E, UniformSource R>
Task<DistanceSample> sampleByNullScattering(E& evaluator, Ray<World> ray, Segment segment, Color throughput, R& random,
                                            GivenDistance* given = nullptr, bool tracks = true) {
  DistanceSample sample;
  sample.pdfKind = PdfKind::joint;
  const ChannelMixture channels(throughput);
  TentativeFlight flight(segment, ray, evaluator.frames());
  LogProduct choices;  // Of the chain: μ̄ and the probability of what happened, for each collision.
  Color weight(1.0f);
  Color light(1.0f);  // Of the emission that is looked for.
  const bool isAnalogue = std::ranges::any_of(segment.media, &Medium::isAnalogue);
  const auto isAsked = [&] { return given && given->concerns(segment); };
  const auto absorb = [&] {
    if (tracks) {
      sample.event = DistanceEvent::absorbed;
      sample.weight = Color();
      tracks = false;
    }
  };
  const float emissionStep = tracks ? emissionStepOf(segment) : std::numeric_limits<float>::infinity();
  bool looks = emissionStep < std::numeric_limits<float>::infinity();
  if (looks) flight.comb().begin(segment.t0, static_cast<double>(emissionStep), static_cast<double>(random.next()));
  bool launches = true;
  for (int step = 0; tracks || looks || isAsked();) {
    if (!looks) flight.comb().end();
    if (launches) flight.launch(static_cast<double>(freeFlight(random.next())));
    Color emission;
    const double stop = isAsked() && given->isIn(segment) ? given->t : std::numeric_limits<double>::infinity();
    TentativeFlight::Arrival arrival = flight.advance(stop, emission);
    if (looks) {
      sample.emission += light * emission;
    } else if (tracks) {
      sample.emission += weight * emission;
    }
    const bool isStep = arrival == TentativeFlight::Arrival::collision || arrival == TentativeFlight::Arrival::light;
    if (isStep && step++ == maximumSteps) {
      ++evaluator.trackerStatistics().stepLimits;
      arrival = TentativeFlight::Arrival::end;
    }
    if (arrival == TentativeFlight::Arrival::end) {
      if (!tracks) break;
      sample.logPdf = choices.logarithm() - flight.depth();
      sample.weight = weight;
      break;
    }
    const bool isCollision = arrival == TentativeFlight::Arrival::collision;
    const bool isLight = arrival == TentativeFlight::Arrival::light;
    launches = isCollision;

    const SegmentWalk& walk = flight.walk();
    const float bound = walk.rate();
    walk.ask(evaluator, pointOn(ray, flight.t()));
    const std::span<const Coefficients> answers = co_await evaluator.answers();
    CoefficientSum sum = walk.known();
    const bool usesComb = walk.emissionStep() < std::numeric_limits<float>::infinity();
    walk.forAnswers(answers, [&](const Medium& medium, const BoundNode& leaf, const Coefficients& c) {
      countViolation(medium, leaf, c.sigmaT, evaluator.trackerStatistics());
      sum.sigmaT += c.sigmaT;
      sum.sigmaS += c.sigmaS;
      if (medium.integratesEmission && usesComb) {
        if (isLight) sample.emission += light * c.emission * static_cast<float>(flight.comb().step());
      } else if (looks && isCollision) {
        sample.emission += light * c.emission / bound;
      } else if (tracks && isCollision) {
        sample.emission += weight * c.emission / bound;
      }
    });
    if (isLight) continue;

    if (!isCollision) {
      const CollisionOdds odds(sum, bound, given->sample.weight, channels, isAnalogue);
      given->sample.t = given->t;
      given->sample.choicePdf *= odds.areNone() ? 0 : static_cast<double>(bound * odds.scatterProbability());
      walk.chooseLobe(answers, given->sample.weight, random.next(), given->sample);
      continue;
    }
    if (isAsked()) {
      const CollisionOdds odds(sum, bound, given->sample.weight, channels, isAnalogue);
      if (odds.areNone()) {
        given->end();
      } else {
        given->pass(odds.sigmaN / bound, static_cast<double>(odds.passProbability()));
        Color& left = given->sample.weight;
        if (!survivesTrackerRoulette(left, channels.mix(abs(left)), random)) given->end();
      }
    }
    if (looks) {
      light *= (Color(bound) - sum.sigmaT) / bound;
      looks = survivesTrackerRoulette(light, channels.mix(abs(light)), random);
    }
    if (!tracks) continue;
    const CollisionOdds odds(sum, bound, weight, channels, isAnalogue);
    if (odds.areNone()) {
      absorb();
      continue;
    }
    const float scatterProbability = odds.scatterProbability(), nullProbability = odds.passProbability();
    const float u = random.next();
    if (u < scatterProbability) {
      sample.t = flight.t();
      choices.multiply(bound * scatterProbability);
      sample.choicePdf *= static_cast<double>(bound * scatterProbability);
      sample.logPdf = choices.logarithm() - flight.depth();
      walk.chooseLobe(answers, weight / (bound * scatterProbability), random.next(), sample);
      tracks = false;
      continue;
    }
    if (isAnalogue && !(u < scatterProbability + nullProbability)) {
      absorb();
      continue;
    }
    choices.multiply(bound * nullProbability);
    sample.choicePdf *= static_cast<double>(nullProbability);
    weight *= odds.sigmaN / (bound * nullProbability);
    if (!survivesTrackerRoulette(weight, channels.mix(abs(weight)), random)) absorb();
  }
  co_return sample;
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

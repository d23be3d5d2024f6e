// Flights from one tentative collision to the next, leaf by leaf of the media's trees.
//
// The bound is piecewise constant along the ray (Szirmay-Kalos et al. 2011): one exponential number is used up by the
// optical distances ∫ μ̄ of the leaves, so nothing is drawn anew at their faces.
#pragma once

#include "core/volume/distance_sample.h"
#include "core/volume/segment_walk.h"
#include "core/volume/segments.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// Notes extinction above what was known of a leaf.
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

/// The same of all that a walk asked for.
inline void countViolations(const SegmentWalk& walk, std::span<const Coefficients> answers,
                            TrackerStatistics& statistics) {
  walk.forAnswers(answers, [&](const Medium& medium, const BoundNode& leaf, const Coefficients& c) {
    countViolation(medium, leaf, c.sigmaT, statistics);
  });
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

}  // namespace aerosol::volume

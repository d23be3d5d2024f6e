// All media of a segment on a ray's way, cut where what is known of any of them changes.
#pragma once

#include <memory>
#include <type_traits>

#include "core/volume/bounds/bound_walk.h"
#include "core/volume/distance_sample.h"
#include "core/volume/frame_stack.h"
#include "core/volume/segments.h"

namespace aerosol::volume {

/// A point of a ray, computed in double and rounded once: far from its origin a float distance is too coarse.
inline Point<World> pointOn(const Ray<World>& ray, double t) {
  const auto along = [t](float origin, float direction) {
    return static_cast<float>(static_cast<double>(origin) + t * static_cast<double>(direction));
  };
  return {along(ray.origin.x, ray.direction.x), along(ray.origin.y, ray.direction.y),
          along(ray.origin.z, ray.direction.z)};
}

/// Stretches of a segment in order along the ray. In each every medium is in one leaf of its tree.
class SegmentWalk {
 public:
  /// `memory` is that of the coroutine in which this stands.
  SegmentWalk(const Segment& segment, const Ray<World>& ray, FrameStack& memory)
      : media_(segment.media), last_(segment.t1), end_(segment.t0) {
    static_assert(std::is_trivially_destructible_v<BoundWalk>);
    if (media_.size() > 1) {
      walks_ = static_cast<BoundWalk*>(memory.allocate(media_.size() * sizeof(BoundWalk)));
      std::uninitialized_default_construct_n(walks_, media_.size());
    }
    for (std::size_t i = 0; i < media_.size(); ++i) walks_[i].begin(*media_[i], ray, segment.t0);
    look();
  }
  ~SegmentWalk() {
    if (walks_ != &only_) FrameStack::free(walks_);
  }
  SegmentWalk(const SegmentWalk&) = delete;
  SegmentWalk& operator=(const SegmentWalk&) = delete;

  double begin() const { return begin_; }
  /// Where the stretch ends; the segment's end for the last one.
  double end() const { return end_; }
  bool isLast() const { return end_ >= last_; }
  /// Are the coefficients of all media the same on the whole stretch?
  bool isKnown() const { return isKnown_; }
  /// Sum of the media's rates of tentative collisions.
  float rate() const { return rate_; }
  /// Distance of the places at which emission is looked for; infinite where there is none, and where collisions, which
  /// find it as well, come so often that they find as much although they are not as even.
  float emissionStep() const { return emissionStep_; }
  /// Sum of the coefficients that are the same on the whole stretch.
  const CoefficientSum& known() const { return known_; }
  /// A tentative collision of one of the media.
  struct Collision {
    const Medium* medium = nullptr;
    BoundNode leaf;
    float rate = 0;                              ///< Of this medium's tentative collisions.
    const Coefficients* coefficients = nullptr;  ///< Null until the medium was asked, where they vary.

    CoefficientSum sum() const { return {coefficients->sigmaT, coefficients->sigmaS, coefficients->emission}; }
    void chooseLobe(Color weight, float u, DistanceSample& sample) const {
      volume::chooseLobe([&](auto&& use) { use(*medium, *coefficients); }, weight, u, sample);
    }
  };
  /// The medium that a tentative collision belongs to, in proportion to the rates; no number is drawn where there is
  /// one only.
  template <UniformSource R>
  Collision collide(R& random) const {
    std::size_t chosen = 0;
    if (media_.size() > 1) {
      float left = random.next() * rate_;
      for (std::size_t i = 0; i < media_.size(); ++i) {
        const float rate = rateOf(i);
        if (!(rate > 0)) continue;
        chosen = i;
        if (left < rate) break;
        left -= rate;
      }
    }
    return {media_[chosen], walks_[chosen].leaf(), rateOf(chosen), walks_[chosen].known()};
  }
  /// What `ask` found of a medium as if it had collided.
  Collision collisionOf(const Medium& medium, std::span<const Coefficients> answers) const {
    std::size_t next = 0;
    for (std::size_t i = 0; i < media_.size(); ++i) {
      const Coefficients* const known = walks_[i].known();
      const Coefficients* const coefficients = known ? known : &answers[next++];
      if (media_[i] == &medium) return {media_[i], walks_[i].leaf(), rateOf(i), coefficients};
    }
    return {};
  }

  /// The leaf of a medium, by its number in the segment.
  const BoundNode& leafOf(std::size_t medium) const { return walks_[medium].leaf(); }

  /// Goes on to the stretch behind `end()`.
  void next() {
    for (std::size_t i = 0; i < media_.size(); ++i) {
      while (walks_[i].end() <= end_) walks_[i].next();
    }
    look();
  }

  /// Asks at a point for what varies.
  template <Evaluator E>
  void ask(E& evaluator, Point<World> point) const {
    for (std::size_t i = 0; i < media_.size(); ++i) {
      if (!walks_[i].known()) evaluator.ask(*media_[i], point, Quantity::coefficients);
    }
  }
  /// Calls `use(medium, leaf, coefficients)` for all that `ask` asked for, with the answers.
  template <class Use>
  void forAnswers(std::span<const Coefficients> answers, Use&& use) const {
    std::size_t next = 0;
    for (std::size_t i = 0; i < media_.size(); ++i) {
      if (!walks_[i].known()) use(*media_[i], walks_[i].leaf(), answers[next++]);
    }
  }
  /// Calls `use(medium, coefficients)` for all media that are the same on the whole stretch.
  template <class Use>
  void forKnown(Use&& use) const {
    for (std::size_t i = 0; i < media_.size(); ++i) {
      if (walks_[i].known()) use(*media_[i], *walks_[i].known());
    }
  }
  /// Of the lobes of all media at the point of the answers; see volume::chooseLobe.
  void chooseLobe(std::span<const Coefficients> answers, Color weight, float u, DistanceSample& sample) const {
    const auto forEach = [&](auto&& use) {
      std::size_t next = 0;
      for (std::size_t i = 0; i < media_.size(); ++i) {
        const Coefficients* const known = walks_[i].known();
        use(*media_[i], known ? *known : answers[next++]);
      }
    };
    volume::chooseLobe(forEach, weight, u, sample);
  }

 private:
  void look() {
    begin_ = end_;
    end_ = last_;
    rate_ = 0;
    emissionStep_ = std::numeric_limits<float>::infinity();
    isKnown_ = true;
    known_ = {};
    for (std::size_t i = 0; i < media_.size(); ++i) {
      const BoundWalk& walk = walks_[i];
      end_ = std::min(end_, walk.end());
      rate_ += rateOf(i);
      if (walk.known()) {
        known_.add(*walk.known());
      } else {
        isKnown_ = false;
        if (media_[i]->integratesEmission) lookForEmission(*media_[i], walk);
      }
    }
    if (!(rate_ > negligibleExtinction)) rate_ = 0;
    if (!(rate_ * emissionStep_ < 4)) emissionStep_ = std::numeric_limits<float>::infinity();
  }

  float rateOf(std::size_t i) const {
    return walks_[i].known() ? walks_[i].leaf().majorant : media_[i]->collisionRate(walks_[i].leaf());
  }

  void lookForEmission(const Medium& medium, const BoundWalk& walk) {
    const BoundRanges* const ranges = walk.ranges();
    const bool mayEmit = !ranges || ranges->emissionHigh > 0 || ranges->emissionLow < 0;
    if (mayEmit) emissionStep_ = std::min(emissionStep_, medium.stepSize);
  }

  std::span<const Medium* const> media_;
  double last_;
  double begin_ = 0, end_ = 0;
  float rate_ = 0, emissionStep_ = std::numeric_limits<float>::infinity();
  bool isKnown_ = true;
  CoefficientSum known_;
  BoundWalk only_;
  BoundWalk* walks_ = &only_;  ///< One a medium; many stand in the coroutine's memory.
};

}  // namespace aerosol::volume

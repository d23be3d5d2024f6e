// Null scattering with a list of candidates.
//
// Miller, Georgiev and Jarosz 2019 ("A Null-Scattering Path Integral Formulation of Light Transport", section 5.2): the
// chain of tentative collisions is run to the end of the segment as for ratio tracking; each of them is a candidate,
// with a share mix(w σs) / μ̄ where w is the weight of the chain so far, and passing is one more with the share of what
// is left. One is chosen in proportion to the shares. So a distance is found in proportion to σs T as far as the chain
// knows it, and no real collision ends the look at what is behind; it costs a chain all the way.
//
// A distance that something else chose is compared with by putting it into the chain: what the list with it would have
// chosen it with. The weights behind it are those of a chain that had a tentative collision there.
#pragma once

#include "core/volume/distance_sample.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"
#include "core/volume/trackers/tentative_flight.h"

namespace aerosol::volume {

/// A chain of tentative collisions with the sum of its candidates' shares.
class CandidateChain {
 public:
  explicit CandidateChain(const ChannelMixture& channels, bool isOn) : channels_(&channels), isOn_(isOn) {}

  bool isOn() const { return isOn_; }
  Color weight() const { return weight_; }
  /// The share of a candidate of the given σs under its bound, which is added to the sum.
  double add(Color sigmaS, float bound) {
    const auto share = static_cast<double>(channels_->mix(abs(weight_ * sigmaS)) / bound);
    sum_ += share;
    return share;
  }
  /// Goes on behind a tentative collision, or ends there by roulette.
  template <UniformSource R>
  void pass(Color factor, R& random) {
    weight_ *= factor;
    isOn_ = survivesTrackerRoulette(weight_, channels_->mix(abs(weight_)), random);
    if (!isOn_) weight_ = Color();
  }
  /// Shares of passing and of everything.
  double passing() const { return static_cast<double>(channels_->mix(abs(weight_))); }
  double sum() const { return sum_ + passing(); }
  double candidates() const { return sum_; }

 private:
  const ChannelMixture* channels_;
  Color weight_{1.0f};
  double sum_ = 0;
  bool isOn_;
};

/// One of the candidates so far, in proportion to their shares.
class ChosenCandidate {
 public:
  /// `sum` is that of all shares, this one included.
  template <UniformSource R>
  void offer(const SegmentWalk::Collision& collision, double t, Color weight, double share, double sum,
             double rateOfAll, R& random) {
    if (!(share > 0) || !(static_cast<double>(random.next()) * sum < share)) return;
    t_ = t;
    weight_ = weight / collision.rate;
    share_ = share;
    overlap_ = rateOfAll;
    medium_ = collision.medium;
    coefficients_ = *collision.coefficients;
  }

  /// Writes it as the outcome of a list whose shares sum up to `sum`.
  void become(DistanceSample& sample, double sum, float u) const {
    const double probability = share_ / sum;
    sample.t = t_;
    sample.choicePdf *= overlap_ * probability;
    sample.logPdf = std::log(probability);
    const auto forEach = [&](auto&& use) { use(*medium_, coefficients_); };
    chooseLobe(forEach, weight_ / static_cast<float>(probability), u, sample);
  }

 private:
  double t_ = 0, share_ = 0, overlap_ = 0;
  Color weight_;
  const Medium* medium_ = nullptr;
  Coefficients coefficients_;
};

/// Samples a distance in a segment, unless `tracks` is false. Every medium needs a tree, a bound or constant
/// coefficients. The pdf is joint with the chain. What lies at a `given` distance is found on the same chain.
template <Evaluator E, UniformSource R>
Task<DistanceSample> sampleFromCandidates(E& evaluator, Ray<World> ray, Segment segment, Color throughput, R& random,
                                          GivenDistance* given = nullptr, bool tracks = true) {
  DistanceSample sample;
  sample.pdfKind = PdfKind::joint;
  const ChannelMixture channels(throughput);
  TentativeFlight flight(segment, ray, evaluator.frames());
  LogProduct rates;
  CandidateChain own(channels, tracks), foreign(channels, given && given->concerns(segment));
  ChosenCandidate chosen;
  const bool isSought = foreign.isOn() && given->isIn(segment);
  bool isFound = false;
  double foundShare = 0;  // Of what was given: its candidate's, times the overlap's factor.
  double depth = 0;       // ∫ μ̄ along the own chain.
  bool launches = true;
  for (int step = 0; own.isOn() || foreign.isOn();) {
    if (launches) flight.launch(static_cast<double>(freeFlight(random.next())));
    Color emission;
    const bool stops = isSought && !isFound && foreign.isOn();
    auto arrival = flight.advance(stops ? given->t : std::numeric_limits<double>::infinity(), emission);
    if (own.isOn()) sample.emission += own.weight() * emission;
    launches = arrival == TentativeFlight::Arrival::collision;
    if (launches && step++ == maximumSteps) {
      ++evaluator.trackerStatistics().stepLimits;
      arrival = TentativeFlight::Arrival::end;
    }
    if (arrival == TentativeFlight::Arrival::end) break;

    const SegmentWalk& walk = flight.walk();
    if (!launches) {
      isFound = true;
      walk.ask(evaluator, pointOn(ray, flight.t()));
      const std::span<const Coefficients> answers = co_await evaluator.answers();
      countViolations(walk, answers, evaluator.trackerStatistics());
      given->sample.t = given->t;
      walk.chooseLobe(answers, given->sample.weight * foreign.weight(), random.next(), given->sample);
      if (given->sample.event != DistanceEvent::scattered) continue;
      const SegmentWalk::Collision found = walk.collisionOf(*given->sample.medium, answers);
      foundShare = foreign.add(found.coefficients->sigmaS, found.rate) * static_cast<double>(walk.rate());
      foreign.pass((Color(found.rate) - found.coefficients->sigmaT) / found.rate, random);
      continue;
    }

    SegmentWalk::Collision collision = walk.collide(random);
    if (!collision.coefficients) {
      evaluator.ask(*collision.medium, pointOn(ray, flight.t()), Quantity::coefficients);
      collision.coefficients = &(co_await evaluator.answers())[0];
      countViolation(*collision.medium, collision.leaf, collision.coefficients->sigmaT, evaluator.trackerStatistics());
      if (own.isOn()) sample.emission += own.weight() * collision.coefficients->emission / collision.rate;
    }
    const Coefficients& c = *collision.coefficients;
    const Color nullFactor = (Color(collision.rate) - c.sigmaT) / collision.rate;
    if (foreign.isOn()) {
      foreign.add(c.sigmaS, collision.rate);
      foreign.pass(nullFactor, random);
    }
    if (!own.isOn()) continue;
    rates.multiply(collision.rate);
    depth = flight.depth();
    const double share = own.add(c.sigmaS, collision.rate);
    chosen.offer(collision, flight.t(), own.weight(), share, own.candidates(), static_cast<double>(walk.rate()),
                 random);
    own.pass(nullFactor, random);
  }
  if (own.isOn()) depth = flight.depth();

  if (given && given->concerns(segment)) {
    if (given->isIn(segment) || !foreign.isOn()) {
      given->end();  // It was lost before it came there.
    } else {
      given->pass(foreign.weight(), foreign.passing() / foreign.sum());
    }
  } else if (isSought && isFound) {
    given->sample.choicePdf *= foundShare > 0 ? foundShare / foreign.sum() : 0;
  }
  if (!tracks) co_return sample;
  const double sum = own.sum();
  if (!(sum > 0)) {
    sample.event = DistanceEvent::absorbed;
    sample.weight = Color();
    co_return sample;
  }
  const double passing = own.passing() / sum;
  if (static_cast<double>(random.next()) < passing) {
    sample.choicePdf = passing;
    sample.logPdf = std::log(passing);
    sample.weight = own.weight() / static_cast<float>(passing);
  } else {
    chosen.become(sample, sum, random.next());
  }
  sample.logPdf += rates.logarithm() - depth;
  co_return sample;
}

}  // namespace aerosol::volume

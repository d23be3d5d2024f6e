// Null scattering: delta tracking for distances.
//
// Woodcock et al. 1965; Galtier et al. 2013; Kutz et al. 2017 (spectral tracking, eq. 25–27): tentative collisions come
// at the rate of the bound μ̄; each is a real or a null collision with probabilities that depend on the path's
// throughput including the weights gathered here (CollisionOdds). Where extinction exceeds the bound, σn = μ̄ − σt is
// negative and so is the weight: the mean stays right as long as the bound is positive, and the excess is counted.
//
// Where media overlap each has collisions of its own: a tentative collision belongs to a medium in proportion to the
// bounds, and that one alone is asked. (The first real collision of independent processes is the least of their
// independent distances; run side by side, no medium is asked behind it.)
//
// Emission that varies is met by the tentative collisions, w ε / μ̄ at each, or along the line: at points of a jittered
// comb, w ε times their distance. Its mean over all flights is the transmittance, so both are unbiased; but collisions
// come at random, and where extinction is small seldom, while the places of the comb are even. Collisions take its part
// where they come several times as often. The light's w is that of ratio tracking, Π σn/μ̄: it does not depend on
// whether any of the collisions was a real one, and goes on behind it.
#pragma once

#include <array>
#include <span>

#include "core/volume/distance_sample.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"
#include "core/volume/trackers/collision_odds.h"
#include "core/volume/trackers/tentative_flight.h"

namespace aerosol::volume {

/// Emission at the place of the comb where a flight has arrived, over the comb's step.
inline Color combedEmission(const SegmentWalk& walk, std::span<const Coefficients> answers, double step) {
  Color sum;
  walk.forAnswers(answers, [&](const Medium& medium, const BoundNode&, const Coefficients& c) {
    if (medium.integratesEmission) sum += c.emission * static_cast<float>(step);
  });
  return sum;
}

/// Places of the comb that have been asked for but not answered yet, on the way through one medium: where they are does
/// not depend on what is there, and waiting for each answer would cost more than the shader does.
class CombedPlaces {
 public:
  static constexpr std::size_t most = 8;

  bool isFull() const { return count_ == most; }
  bool isEmpty() const { return count_ == 0; }
  std::size_t count() const { return count_; }
  /// `weight` is the light's there, times the comb's step.
  void add(const BoundNode& leaf, Color weight) { places_[count_++] = {leaf, weight}; }
  /// Their emission; the first of the answers are theirs.
  Color take(const Medium& medium, std::span<const Coefficients> answers, TrackerStatistics& statistics) {
    Color sum;
    for (std::size_t i = 0; i < count_; ++i) {
      countViolation(medium, places_[i].leaf, answers[i].sigmaT, statistics);
      sum += places_[i].weight * answers[i].emission;
    }
    count_ = 0;
    return sum;
  }

 private:
  struct Place {
    BoundNode leaf;
    Color weight;
  };
  std::array<Place, most> places_;
  std::size_t count_ = 0;
};

/// Samples a distance in a segment, unless `tracks` is false. Every medium needs a tree, a bound or constant
/// coefficients. The pdf is joint with the chain. What lies at a `given` distance is found on the same way: behind the
/// real collision the chain of tentative ones goes on for it alone. Where media overlap, `choicePdf` is that of the
/// medium's own collisions as if it had all of the bound: the same for both, which is what weights of techniques need.
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
  CombedPlaces combed;
  const Medium* const only = segment.media.size() == 1 ? segment.media.front() : nullptr;
  const auto takeCombed = [&](std::span<const Coefficients> answers) {
    const std::size_t count = combed.count();
    if (count > 0) sample.emission += combed.take(*only, answers, evaluator.trackerStatistics());
    return count;
  };
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
    launches = arrival == TentativeFlight::Arrival::collision;

    const SegmentWalk& walk = flight.walk();
    if (arrival == TentativeFlight::Arrival::light && only && !combed.isFull()) {
      evaluator.ask(*only, pointOn(ray, flight.t()), Quantity::coefficients);
      combed.add(walk.leafOf(0), light * static_cast<float>(flight.comb().step()));
      continue;
    }
    if (!launches) {
      walk.ask(evaluator, pointOn(ray, flight.t()));
      std::span<const Coefficients> answers = co_await evaluator.answers();
      answers = answers.subspan(takeCombed(answers));
      countViolations(walk, answers, evaluator.trackerStatistics());
      if (arrival == TentativeFlight::Arrival::light) {
        sample.emission += light * combedEmission(walk, answers, flight.comb().step());
        continue;
      }
      const Color before = given->sample.weight;
      given->sample.t = given->t;
      walk.chooseLobe(answers, before, random.next(), given->sample);
      if (given->sample.event != DistanceEvent::scattered) continue;
      const SegmentWalk::Collision found = walk.collisionOf(*given->sample.medium, answers);
      const CollisionOdds odds(found.sum(), found.rate, found.leaf.control, found.medium->collisions, before, channels);
      given->sample.choicePdf *= static_cast<double>(walk.rate() * odds.scatterProbability());
      continue;
    }

    SegmentWalk::Collision collision = walk.collide(random);
    if (!collision.coefficients) {
      evaluator.ask(*collision.medium, pointOn(ray, flight.t()), Quantity::coefficients);
      const std::span<const Coefficients> answers = co_await evaluator.answers();
      collision.coefficients = &answers[takeCombed(answers)];
      countViolation(*collision.medium, collision.leaf, collision.coefficients->sigmaT, evaluator.trackerStatistics());
      const bool isCombed =
          collision.medium->integratesEmission && walk.emissionStep() < std::numeric_limits<float>::infinity();
      if (!isCombed && (looks || tracks)) {
        sample.emission += (looks ? light : weight) * collision.coefficients->emission / collision.rate;
      }
    }
    const CoefficientSum sum = collision.sum();
    const Collisions kind = collision.medium->collisions;
    if (isAsked()) {
      const CollisionOdds odds(sum, collision.rate, collision.leaf.control, kind, given->sample.weight, channels);
      if (odds.areNone()) {
        given->end();
      } else {
        given->pass(odds.sigmaN() / collision.rate, static_cast<double>(odds.passProbability()));
        Color& left = given->sample.weight;
        if (!survivesTrackerRoulette(left, channels.mix(abs(left)), random)) given->end();
      }
    }
    if (looks) {
      light *= (Color(collision.rate) - sum.sigmaT) / collision.rate;
      looks = survivesTrackerRoulette(light, channels.mix(abs(light)), random);
    }
    if (!tracks) continue;
    const CollisionOdds odds(sum, collision.rate, collision.leaf.control, kind, weight, channels);
    if (odds.areNone()) {
      absorb();
      continue;
    }
    const float scatterProbability = odds.scatterProbability(), nullProbability = odds.passProbability();
    const float u = random.next();
    if (u < scatterProbability) {
      sample.t = flight.t();
      choices.multiply(collision.rate * scatterProbability);
      sample.choicePdf *= static_cast<double>(walk.rate() * scatterProbability);
      sample.logPdf = choices.logarithm() - flight.depth();
      collision.chooseLobe(weight / (collision.rate * scatterProbability), random.next(), sample);
      tracks = false;
      continue;
    }
    if (kind == Collisions::analogue && !(u < scatterProbability + nullProbability)) {
      absorb();
      continue;
    }
    choices.multiply(collision.rate * nullProbability);
    sample.choicePdf *= static_cast<double>(nullProbability);
    weight *= odds.sigmaN() / (collision.rate * nullProbability);
    if (!survivesTrackerRoulette(weight, channels.mix(abs(weight)), random)) absorb();
  }
  if (!combed.isEmpty()) takeCombed(co_await evaluator.answers());
  co_return sample;
}

}  // namespace aerosol::volume

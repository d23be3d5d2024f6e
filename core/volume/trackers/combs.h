// Transmittance from jittered combs: equidistant points with one random offset, whose mean is an unbiased estimate of
// the optical depth with little variance. What is made of such estimates decides about the bias.
//
// - Two combs (Peters 2025): of two depths a, b of the same way exp(-(a + b) / 2) cos((a - b) / 2). It is the real part
//   of exp(-(1 - i) a / 2) exp(-(1 + i) b / 2), in whose mean the variance of the depths cancels: what is left of the
//   bias is of the order of its fourth moment.
// - Unbiased ray marching (Kettunen, d'Eon, Pantaleoni and Novák 2021, "An Unbiased Ray-Marching Transmittance
//   Estimator"): the power series of exp around one of N + 1 depths, the products of the others taken as the mean over
//   all choices of them (a U-statistic), N cut off by Bhanot–Kennedy roulette, the mean over which one is the pivot.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "core/volume/bounds/bound_walk.h"
#include "core/volume/distance_sample.h"
#include "core/volume/few_or_many.h"
#include "core/volume/segment_walk.h"
#include "core/volume/task.h"
#include "core/volume/trackers/ray_marching.h"

namespace aerosol::volume {

using ChannelDepths = std::array<double, 3>;

/// What a span of one medium consists of: the depth that is known, and the parts in which coefficients vary.
class VaryingParts {
 public:
  VaryingParts(const Medium& medium, const Ray<World>& ray, const MediumSpan& span) {
    BoundWalk walk(medium, ray, span.t0);
    for (double t = span.t0; t < span.t1;) {
      const double end = std::min(walk.end(), span.t1);
      if (const Coefficients* known = walk.known()) {
        for (int c = 0; c < 3; ++c) {
          if (known->sigmaT[c] > 0)
            known_[static_cast<std::size_t>(c)] += static_cast<double>(known->sigmaT[c]) * (end - t);
        }
      } else if (end > t) {
        bound_ += static_cast<double>(medium.shadowRate(walk.leaf())) * (end - t);
        length_ += end - t;
        if (parts_.size() > 0 && parts_[parts_.size() - 1].t1 == t) {
          parts_[parts_.size() - 1].t1 = end;
        } else {
          parts_.push_back({t, end});
        }
      }
      t = end;
      if (t < span.t1) walk.next();
    }
  }

  const ChannelDepths& known() const { return known_; }
  double length() const { return length_; }  ///< Of all parts.
  double bound() const { return bound_; }    ///< ∫ μ̄ over them.
  /// The place on the ray behind a length of varying parts, in [0, length).
  double place(double behind) const {
    for (std::size_t i = 0; i + 1 < parts_.size(); ++i) {
      const double length = parts_[i].t1 - parts_[i].t0;
      if (behind < length) return parts_[i].t0 + behind;
      behind -= length;
    }
    const Part& last = parts_[parts_.size() - 1];
    return std::min(last.t0 + behind, last.t1);
  }

 private:
  struct Part {
    double t0 = 0, t1 = 0;
  };
  FewOrMany<Part, 4> parts_;
  ChannelDepths known_{};
  double length_ = 0, bound_ = 0;
};

/// The depth of the varying parts by `count` points, the first one `offset` (in [0, 1)) of the way to the second.
template <Evaluator E>
Task<ChannelDepths> combDepth(E& evaluator, const Ray<World>& ray, const Medium& medium, const VaryingParts& parts,
                              int count, double offset) {
  ChannelDepths depth{};
  const double step = parts.length() / count;
  for (int first = 0; first < count; first += largestGroup) {
    const int end = std::min(first + largestGroup, count);
    for (int i = first; i < end; ++i) {
      evaluator.ask(medium, pointOn(ray, parts.place((i + offset) * step)), Quantity::extinction);
    }
    for (const Coefficients& answer : co_await evaluator.answers()) {
      for (int c = 0; c < 3; ++c) depth[static_cast<std::size_t>(c)] += static_cast<double>(answer.sigmaT[c]) * step;
    }
  }
  co_return depth;
}

/// At most so many points of one comb; a longer way gets wider steps, and is counted.
inline constexpr int longestComb = 1 << 16;

inline int combPoints(double wanted, TrackerStatistics& statistics) {
  if (wanted < longestComb) return std::max(1, static_cast<int>(std::ceil(wanted)));
  ++statistics.stepLimits;
  return longestComb;
}

inline float transmittanceOf(double known, double factor) { return static_cast<float>(std::exp(-known) * factor); }

/// By two combs of two steps each, so that both together cost as much as marching. Three random numbers.
template <Evaluator E, UniformSource R>
Task<Color> twoCombTransmittance(E& evaluator, Ray<World> ray, MediumSpan span, float stepSize, R& random) {
  const Medium& medium = *span.medium;
  const VaryingParts parts(medium, ray, span);
  if (!(parts.length() > 0)) {
    co_return Color(transmittanceOf(parts.known()[0], 1), transmittanceOf(parts.known()[1], 1),
                    transmittanceOf(parts.known()[2], 1));
  }
  if (!std::isfinite(parts.length())) co_return co_await marchedTransmittance(evaluator, ray, span, stepSize, random);
  const double jitter = static_cast<double>(random.next());
  const double wanted = std::floor(parts.length() / (2 * static_cast<double>(stepSize)) + jitter);
  const int count = combPoints(wanted, evaluator.trackerStatistics());
  const double offset = static_cast<double>(random.next());
  const ChannelDepths a = co_await combDepth(evaluator, ray, medium, parts, count, offset);
  const ChannelDepths b = co_await combDepth(evaluator, ray, medium, parts, count, static_cast<double>(random.next()));
  Color transmittance;
  for (std::size_t c = 0; c < 3; ++c) {
    const double factor = std::exp(-0.5 * (a[c] + b[c])) * std::cos(0.5 * (a[c] - b[c]));
    transmittance[static_cast<int>(c)] = transmittanceOf(parts.known()[c], factor);
  }
  co_return transmittance;
}

/// How many terms of the power series, and what each weighs for having been reached.
class SeriesRoulette {
 public:
  static constexpr int most = 24;  ///< The probability to reach it is 1e-21.

  /// Terms 1 and 2 with probability 1/10, each further one i with 2 / i of the one before (Kettunen et al., section 5).
  explicit SeriesRoulette(double u) {
    double reached = 0.1;
    for (order_ = 0; order_ < most && u < reached; ++order_) {
      weights_[static_cast<std::size_t>(order_ + 1)] = 1 / reached;
      if (order_ + 1 >= 2) reached *= std::min(1.0, 2.0 / (order_ + 2));
    }
  }
  int order() const { return order_; }
  double weight(int term) const { return weights_[static_cast<std::size_t>(term)]; }

 private:
  std::array<double, most + 1> weights_{1};
  int order_ = 0;
};

/// The estimate of exp(-E[depth]) from depths that are independent and equally distributed, one more of them than the
/// order: the mean over the pivots of e^(-pivot) Σ w_k / k! · (mean product of k of the other differences).
inline double seriesEstimate(std::span<const double> depths, const SeriesRoulette& roulette) {
  const int order = roulette.order();
  double sum = 0;
  for (std::size_t pivot = 0; pivot < depths.size(); ++pivot) {
    // Elementary symmetric polynomials, one more difference at a time.
    std::array<double, SeriesRoulette::most + 1> products{1};
    int count = 0;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      if (i == pivot) continue;
      ++count;
      const double difference = depths[pivot] - depths[i];
      for (int k = count; k > 0; --k) {
        products[static_cast<std::size_t>(k)] += difference * products[static_cast<std::size_t>(k - 1)];
      }
    }
    double series = 0, chosen = 1;  // k! · (order choose k).
    for (int k = 0; k <= order; ++k) {
      series += roulette.weight(k) * products[static_cast<std::size_t>(k)] / chosen;
      chosen *= order - k;
    }
    sum += std::exp(-depths[pivot]) * series;
  }
  return sum / static_cast<double>(depths.size());
}

/// By unbiased ray marching; the number of points in a comb follows from the bound, or from the step where none is
/// known. Signed.
template <Evaluator E, UniformSource R>
Task<Color> unbiasedMarchingTransmittance(E& evaluator, Ray<World> ray, MediumSpan span, float stepSize, R& random) {
  const Medium& medium = *span.medium;
  const VaryingParts parts(medium, ray, span);
  if (!(parts.length() > 0)) {
    co_return Color(transmittanceOf(parts.known()[0], 1), transmittanceOf(parts.known()[1], 1),
                    transmittanceOf(parts.known()[2], 1));
  }
  if (!std::isfinite(parts.length())) co_return co_await marchedTransmittance(evaluator, ray, span, stepSize, random);
  const double c = parts.bound();
  const double wanted =
      medium.bound ? std::cbrt((0.015 + c) * (0.65 + c) * (60.3 + c)) : parts.length() / static_cast<double>(stepSize);
  const int count = combPoints(wanted, evaluator.trackerStatistics());
  // Rare orders need more digits than one number has.
  const double coarse = static_cast<double>(random.next());
  const SeriesRoulette roulette(coarse + 0x1p-24 * static_cast<double>(random.next()));
  std::array<std::array<double, SeriesRoulette::most + 1>, 3> depths{};
  const auto combs = static_cast<std::size_t>(roulette.order() + 1);
  for (std::size_t i = 0; i < combs; ++i) {
    const ChannelDepths depth =
        co_await combDepth(evaluator, ray, medium, parts, count, static_cast<double>(random.next()));
    for (std::size_t channel = 0; channel < 3; ++channel) depths[channel][i] = depth[channel];
  }
  Color transmittance;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    transmittance[static_cast<int>(channel)] =
        transmittanceOf(parts.known()[channel], seriesEstimate({depths[channel].data(), combs}, roulette));
  }
  co_return transmittance;
}

}  // namespace aerosol::volume

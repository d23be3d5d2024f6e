// Ray marching: the segment is cut into equal cells, each taken as homogeneous with the coefficients of one point.
//
// Kulla 2019 ("Path Tracing in Production – Volumes"): two random numbers a segment, one for the stratified offset of
// the points in their cells, one for the number of cells. Biased, consistent as the step goes to zero. Points are asked
// for in groups of growing size, front to back, and marching stops where the distance was found.
#pragma once

#include <array>
#include <limits>

#include "core/volume/distance_sample.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// The cells of one segment: `count` cells of length `step`, sampled at `offset` (in [0, 1)) of each. There are at most
/// `maximumSteps`: a segment that is too long for its step gets longer ones, an infinite one ends there.
struct MarchingCells {
  int count = 1;
  float step = 0;
  float offset = 0.5f;
  bool isLimited = false;

  /// `u` rounds the count up or down at random, so that cell boundaries never line up from ray to ray.
  MarchingCells(float length, float stepSize, float u, float offset_) : offset(offset_) {
    const float wanted = length / stepSize;
    isLimited = !(wanted < static_cast<float>(maximumSteps));
    count = isLimited ? maximumSteps : std::max(1, static_cast<int>(wanted + u));
    step = std::isfinite(length) ? length / static_cast<float>(count) : stepSize;
  }
  float point(float t0, int cell) const { return t0 + (static_cast<float>(cell) + offset) * step; }
};

inline constexpr int firstGroup = 8;     ///< Cells asked for at once, at first,
inline constexpr int largestGroup = 64;  ///< and at most.

/// Samples a distance in a segment: channel c's distance is where its optical depth reaches -log(1 - ξ); the pdf is the
/// mixture over the channels, piecewise exponential over the cells (marginal).
template <Evaluator E, UniformSource R>
Task<DistanceSample> sampleByMarching(E& evaluator, Ray<World> ray, Segment segment, float stepSize, Color throughput,
                                      R& random) {
  const float jitter = random.next();
  const MarchingCells cells(segment.t1 - segment.t0, stepSize, jitter, random.next());
  evaluator.trackerStatistics().stepLimits += cells.isLimited;
  const ChannelMixture channels(throughput);
  float u = random.next();
  const int channel = channels.choose(u);
  const double targetDepth = -std::log1p(-static_cast<double>(u));

  DistanceSample sample;
  std::array<double, 3> depth{};
  const auto transmittanceAt = [&](Color sigmaT, float distance) {
    return Color(static_cast<float>(std::exp(-depth[0] - static_cast<double>(sigmaT.r) * distance)),
                 static_cast<float>(std::exp(-depth[1] - static_cast<double>(sigmaT.g) * distance)),
                 static_cast<float>(std::exp(-depth[2] - static_cast<double>(sigmaT.b) * distance)));
  };
  int group = firstGroup;
  for (int first = 0; first < cells.count; first += group, group = std::min(2 * group, largestGroup)) {
    group = std::min(group, cells.count - first);
    for (int i = 0; i < group; ++i) askSegment(evaluator, segment.media, ray.at(cells.point(segment.t0, first + i)));
    const std::span<const Coefficients> answers = co_await evaluator.answers();
    std::size_t next = 0;
    for (int i = 0; i < group; ++i) {
      const std::size_t cellBegin = next;
      CoefficientSum sum;
      for (const Medium* medium : segment.media) sum.add(coefficientsOf(*medium, answers, next));

      const double sigma = sum.sigmaT[channel];
      const auto channelIndex = static_cast<std::size_t>(channel);
      const bool hit = depth[channelIndex] + sigma * cells.step > targetDepth;
      const float travelled =
          hit ? std::min(static_cast<float>((targetDepth - depth[channelIndex]) / sigma), cells.step) : cells.step;
      if (!isBlack(sum.emission)) {
        // Expected value over the whole cell for a path that came as far as its beginning: ∫ T ε ds / P(beginning).
        const Color begin = transmittanceAt(Color(), 0);
        const float reach = channels.mix(begin);
        if (reach > 0) {
          sample.emission += sum.emission * (begin / reach) * transmittedLength(sum.sigmaT, cells.step);
        }
      }
      if (hit) {
        const Color transmittance = transmittanceAt(sum.sigmaT, travelled);
        const float pdf = channels.mix(sum.sigmaT * transmittance);
        sample.t = std::min(segment.t0 + static_cast<float>(first + i) * cells.step + travelled, segment.t1);
        sample.logPdf = std::log(static_cast<double>(pdf));
        if (pdf > std::numeric_limits<float>::min()) {
          chooseLobe(segment.media, answers.subspan(cellBegin), transmittance / pdf, random.next(), sample);
        } else {
          sample.event = DistanceEvent::absorbed;
          sample.weight = Color();
        }
        co_return sample;
      }
      for (int c = 0; c < 3; ++c) depth[static_cast<std::size_t>(c)] += static_cast<double>(sum.sigmaT[c]) * cells.step;
    }
  }
  const Color transmittance = transmittanceAt(Color(), 0);
  const float passProbability = channels.mix(transmittance);
  sample.logPdf = std::log(static_cast<double>(passProbability));
  sample.weight = passProbability > 0 ? transmittance / passProbability : Color();
  co_return sample;
}

/// Transmittance of one medium over a span by the same cells. Stops where no channel lets 1e-7 through.
template <Evaluator E, UniformSource R>
Task<Color> marchedTransmittance(E& evaluator, Ray<World> ray, MediumSpan span, float stepSize, R& random) {
  const float jitter = random.next();
  const MarchingCells cells(span.t1 - span.t0, stepSize, jitter, random.next());
  evaluator.trackerStatistics().stepLimits += cells.isLimited;
  std::array<double, 3> depth{};
  int group = 2 * firstGroup;
  for (int first = 0; first < cells.count; first += group, group = std::min(2 * group, largestGroup)) {
    group = std::min(group, cells.count - first);
    for (int i = 0; i < group; ++i)
      evaluator.ask(*span.medium, ray.at(cells.point(span.t0, first + i)), Quantity::extinction);
    const std::span<const Coefficients> answers = co_await evaluator.answers();
    for (int i = 0; i < group; ++i) {
      const Color sigmaT = answers[static_cast<std::size_t>(i)].sigmaT;
      for (int c = 0; c < 3; ++c) depth[static_cast<std::size_t>(c)] += static_cast<double>(sigmaT[c]) * cells.step;
    }
    if (std::min({depth[0], depth[1], depth[2]}) > 16.2) co_return Color();
  }
  co_return Color(static_cast<float>(std::exp(-depth[0])), static_cast<float>(std::exp(-depth[1])),
                  static_cast<float>(std::exp(-depth[2])));
}

}  // namespace aerosol::volume

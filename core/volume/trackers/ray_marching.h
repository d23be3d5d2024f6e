// Ray marching: the segment is cut into equal cells, each taken as homogeneous with the coefficients of one point.
//
// Kulla 2019 ("Path Tracing in Production – Volumes"): two random numbers a segment, one for the stratified offset of
// the points in their cells, one for the number of cells. Biased, consistent as the step goes to zero. Points are asked
// for in groups of growing size, front to back, and marching stops where the distance was found. Empty stretches and
// those with the same coefficients all over cost no point.
#pragma once

#include <array>
#include <limits>

#include "core/volume/distance_sample.h"
#include "core/volume/segment_walk.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// How a ray is cut into cells: `count` cells of length `step`, sampled at `offset` (in [0, 1)) of each. There are at
/// most `maximumSteps` of a stretch: one that is too long for its step gets longer ones, an infinite one ends there.
struct MarchingCells {
  int count = 1;
  double step = 0;
  float offset = 0.5f;
  bool isLimited = false;

  /// `u` rounds the count up or down at random, so that cell boundaries never line up from ray to ray.
  MarchingCells(double length, float stepSize, float u, float offset_) : offset(offset_) {
    const double wanted = length / static_cast<double>(stepSize);
    isLimited = !(wanted < static_cast<double>(maximumSteps));
    count = isLimited ? maximumSteps : std::max(1, static_cast<int>(wanted + static_cast<double>(u)));
    step = std::isfinite(length) ? length / static_cast<double>(count) : static_cast<double>(stepSize);
  }
  double point(double t0, int cell) const { return t0 + (cell + static_cast<double>(offset)) * step; }
};

inline constexpr int firstGroup = 8;     ///< Cells asked for at once, at first,
inline constexpr int largestGroup = 64;  ///< and at most.

/// A distance sampled front to back, cell by cell: channel c's distance is where its optical depth reaches -log(1 - ξ);
/// the pdf is the mixture over the channels, piecewise exponential over the cells (marginal).
class MarchedDistance {
 public:
  MarchedDistance(Color throughput, float u) : channels_(throughput) {
    channel_ = channels_.choose(u);
    targetDepth_ = -std::log1p(-static_cast<double>(u));
  }

  /// Adds a cell. True when the distance lies in it: then `sample` has its place and pdf, and `weight` is T / pdf.
  bool add(const CoefficientSum& cell, double t, double length, DistanceSample& sample, Color& weight) {
    if (!isBlack(cell.emission)) {
      // Expected value over the whole cell for a path that came as far as its beginning: ∫ T ε ds / P(beginning).
      const Color begin = transmittanceAt(Color(), 0);
      const float reach = channels_.mix(begin);
      if (reach > 0) {
        sample.emission += cell.emission * (begin / reach) * transmittedLength(cell.sigmaT, static_cast<float>(length));
      }
    }
    const auto sigma = static_cast<double>(cell.sigmaT[channel_]);
    double& depth = depth_[static_cast<std::size_t>(channel_)];
    if (sigma > 0 && depth + sigma * length > targetDepth_) {
      const double travelled = std::min((targetDepth_ - depth) / sigma, length);
      const Color transmittance = transmittanceAt(cell.sigmaT, travelled);
      const float pdf = channels_.mix(cell.sigmaT * transmittance);
      sample.t = t + travelled;
      sample.logPdf = std::log(static_cast<double>(pdf));
      weight = pdf > std::numeric_limits<float>::min() ? transmittance / pdf : Color();
      return true;
    }
    for (int c = 0; c < 3; ++c) {
      if (cell.sigmaT[c] > 0) depth_[static_cast<std::size_t>(c)] += static_cast<double>(cell.sigmaT[c]) * length;
    }
    return false;
  }

  void pass(DistanceSample& sample) const {
    const Color transmittance = transmittanceAt(Color(), 0);
    const float passProbability = channels_.mix(transmittance);
    sample.logPdf = std::log(static_cast<double>(passProbability));
    sample.weight = passProbability > 0 ? transmittance / passProbability : Color();
  }

 private:
  Color transmittanceAt(Color sigmaT, double distance) const {
    return Color(static_cast<float>(std::exp(-depth_[0] - static_cast<double>(sigmaT.r) * distance)),
                 static_cast<float>(std::exp(-depth_[1] - static_cast<double>(sigmaT.g) * distance)),
                 static_cast<float>(std::exp(-depth_[2] - static_cast<double>(sigmaT.b) * distance)));
  }

  ChannelMixture channels_;
  int channel_ = 0;
  double targetDepth_ = 0;
  std::array<double, 3> depth_{};
};

/// Samples a distance in a segment. A stretch on which all coefficients are known is one exact cell; everything between
/// two such stretches is cut into equal cells.
template <Evaluator E, UniformSource R>
Task<DistanceSample> sampleByMarching(E& evaluator, Ray<World> ray, Segment segment, float stepSize, Color throughput,
                                      R& random) {
  const float jitter = random.next(), offset = random.next();
  MarchedDistance marched(throughput, random.next());
  DistanceSample sample;
  Color weight;
  SegmentWalk walk(segment, ray, evaluator.frames());
  for (double t = segment.t0;;) {
    if (walk.isKnown()) {
      if (marched.add(walk.known(), t, walk.end() - t, sample, weight)) {
        walk.chooseLobe({}, weight, random.next(), sample);
        co_return sample;
      }
      t = walk.end();
    } else {
      while (!walk.isLast() && !walk.isKnown()) walk.next();
      const double end = walk.isKnown() ? walk.begin() : walk.end();
      const MarchingCells cells(end - t, stepSize, jitter, offset);
      evaluator.trackerStatistics().stepLimits += cells.isLimited;
      int group = firstGroup;
      for (int cell = 0; cell < cells.count; cell += group, group = std::min(2 * group, largestGroup)) {
        group = std::min(group, cells.count - cell);
        for (int i = 0; i < group; ++i) {
          for (const Medium* medium : segment.media) {
            if (!medium->constant) {
              evaluator.ask(*medium, pointOn(ray, cells.point(t, cell + i)), Quantity::coefficients);
            }
          }
        }
        const std::span<const Coefficients> answers = co_await evaluator.answers();
        std::size_t next = 0;
        for (int i = 0; i < group; ++i) {
          const std::size_t first = next;
          CoefficientSum sum;
          for (const Medium* medium : segment.media) {
            sum.add(medium->constant ? *medium->constant : answers[next++]);
          }
          if (!marched.add(sum, t + (cell + i) * cells.step, cells.step, sample, weight)) continue;
          sample.t = std::min(sample.t, end);
          const auto forEach = [&](auto&& use) {
            std::size_t answer = first;
            for (const Medium* medium : segment.media)
              use(*medium, medium->constant ? *medium->constant : answers[answer++]);
          };
          chooseLobe(forEach, weight, random.next(), sample);
          co_return sample;
        }
      }
      t = end;
      if (walk.isKnown()) continue;
    }
    if (walk.isLast()) break;
    walk.next();
  }
  marched.pass(sample);
  co_return sample;
}

/// Optical depth from which no light is left: 1e-7 of it.
inline constexpr double opaqueDepth = 16.2;

/// Transmittance of one medium over a span by the same cells. Stops where no channel lets 1e-7 through.
template <Evaluator E, UniformSource R>
Task<Color> marchedTransmittance(E& evaluator, Ray<World> ray, MediumSpan span, float stepSize, R& random) {
  const float jitter = random.next(), offset = random.next();
  std::array<double, 3> depth{};
  const auto add = [&](Color sigmaT, double length) {
    for (int c = 0; c < 3; ++c) {
      if (sigmaT[c] > 0) depth[static_cast<std::size_t>(c)] += static_cast<double>(sigmaT[c]) * length;
    }
    return std::min({depth[0], depth[1], depth[2]}) > opaqueDepth;
  };
  BoundWalk walk(*span.medium, ray, span.t0);
  for (double t = span.t0; t < span.t1;) {
    double end = std::min(walk.end(), span.t1);
    if (const Coefficients* known = walk.known()) {
      if (add(known->sigmaT, end - t)) co_return Color();
      if (end < span.t1) walk.next();
    } else {
      for (; end < span.t1 && !walk.known(); end = walk.known() ? end : std::min(walk.end(), span.t1)) walk.next();
      const MarchingCells cells(end - t, stepSize, jitter, offset);
      evaluator.trackerStatistics().stepLimits += cells.isLimited;
      int group = 2 * firstGroup;
      for (int first = 0; first < cells.count; first += group, group = std::min(2 * group, largestGroup)) {
        group = std::min(group, cells.count - first);
        for (int i = 0; i < group; ++i)
          evaluator.ask(*span.medium, pointOn(ray, cells.point(t, first + i)), Quantity::extinction);
        const std::span<const Coefficients> answers = co_await evaluator.answers();
        bool isOpaque = false;
        for (int i = 0; i < group; ++i) isOpaque = add(answers[static_cast<std::size_t>(i)].sigmaT, cells.step);
        if (isOpaque) co_return Color();
      }
    }
    t = end;
  }
  co_return Color(static_cast<float>(std::exp(-depth[0])), static_cast<float>(std::exp(-depth[1])),
                  static_cast<float>(std::exp(-depth[2])));
}

}  // namespace aerosol::volume

// Ray marching: the segment is cut into equal cells, each taken as homogeneous with the coefficients of one point.
//
// Kulla 2019 ("Path Tracing in Production – Volumes"): two random numbers a segment, one for the stratified offset of
// the points in their cells, one for the number of cells. Biased, consistent as the step goes to zero. Points are asked
// for in groups of growing size, front to back. Cells go into a table, from which the distance is chosen; marching ends
// where next to nothing is left of the light. Empty stretches and those with the same coefficients all over cost no
// point: one step leads through them.
#pragma once

#include <array>
#include <limits>

#include "core/volume/distance_sample.h"
#include "core/volume/segment_walk.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"
#include "core/volume/trackers/marching_table.h"

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

/// Behind where less of the light is left, lights are not tabulated: what scatters there samples them by itself.
inline constexpr float leastTabulated = 1e-4f;

/// The outcomes of one marched segment: of the tracker's own distance, and of a given one.
template <UniformSource R>
class MarchedOutcome {
 public:
  MarchedOutcome(MarchingTable& table, Color throughput, R& random, GivenDistance* given, bool tracks)
      : channels_(throughput), table_(table), random_(random), given_(given), tracks_(tracks) {
    table_.begin(channels_);
  }

  MarchingTable& table() { return table_; }
  DistanceSample& sample() { return sample_; }

  /// Decides over the cells so far. False when the rest of the segment is of no interest to anyone.
  bool close(const Segment& segment) {
    if (table_.isEmpty()) return true;
    const Color before = given_ ? given_->sample.weight : Color();
    const bool finds = given_ && given_->concerns(segment);
    if (finds) {
      if (given_->lights) table_.tabulate(*given_->lights, before, given_->sample.choicePdf, random_);
      table_.find(*given_, random_);
      Color& left = given_->sample.weight;
      // With roulette what one technique finds would depend on what became of the other.
      if (given_->lights && channels_.mix(abs(left)) < leastTabulated) given_->end();
      if (!given_->lights && given_->isOpen() && !survivesTrackerRoulette(left, channels_.mix(abs(left)), random_))
        given_->end();
    }
    if (tracks_) {
      sample_.emission += sample_.weight * table_.emission();
      table_.sample(static_cast<double>(random_.next()), random_, sample_);
      tracks_ = sample_.event == DistanceEvent::passed;
      if (finds && given_->lights && !tracks_) sample_.lightScale = table_.lightScaleAt(sample_.t, before);
    }
    table_.begin(channels_);
    return tracks_ || (given_ && given_->concerns(segment));
  }

 private:
  ChannelMixture channels_;
  MarchingTable& table_;
  R& random_;
  GivenDistance* given_;
  bool tracks_;
  DistanceSample sample_;
};

/// Samples a distance in a segment, unless `tracks` is false, and finds what lies at a `given` one in the same cells. A
/// stretch on which all coefficients are known is one exact cell; everything between two such stretches is cut into
/// equal cells. `table` is scratch.
template <Evaluator E, UniformSource R>
Task<DistanceSample> sampleByMarching(E& evaluator, Ray<World> ray, Segment segment, float stepSize, Color throughput,
                                      R& random, MarchingTable& table, GivenDistance* given = nullptr,
                                      bool tracks = true) {
  const float jitter = random.next(), offset = random.next();
  MarchedOutcome<R> outcome(table, throughput, random, given, tracks);
  SegmentWalk walk(segment, ray, evaluator.frames());
  for (double t = segment.t0;;) {
    if (walk.isKnown()) {
      // For tabulated lights the light that is left must not fall by much within a cell.
      const double depth = static_cast<double>(maximum(walk.known().sigmaT)) * (walk.end() - t);
      const int parts =
          given && given->lights && std::isfinite(depth) ? 1 + static_cast<int>(std::min(2 * depth, 31.0)) : 1;
      const double part = (walk.end() - t) / parts;
      for (int i = 0; i < parts; ++i) {
        table.add(walk.known(), t + i * part, part);
        walk.forKnown([&](const Medium& medium, const Coefficients& known) { table.addLobes(medium, known); });
      }
      if (table.isFull() && !outcome.close(segment)) co_return outcome.sample();
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
          for (const Medium* medium : segment.media) sum.add(medium->constant ? *medium->constant : answers[next++]);
          // The last cell ends where the stretch does, whatever rounding says.
          const double begin = t + (cell + i) * cells.step;
          table.add(sum, begin, cell + i + 1 == cells.count && std::isfinite(end) ? end - begin : cells.step);
          next = first;
          for (const Medium* medium : segment.media) {
            table.addLobes(*medium, medium->constant ? *medium->constant : answers[next++]);
          }
          if (table.isFull() && !outcome.close(segment)) co_return outcome.sample();
        }
      }
      t = end;
      if (walk.isKnown()) continue;
    }
    if (walk.isLast()) break;
    walk.next();
  }
  outcome.close(segment);
  co_return outcome.sample();
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

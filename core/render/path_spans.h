// The media along a path's ray: surface-defined ones first, then volume primitives as the scene's design finds them.
#pragma once

#include <vector>

#include "core/accel/span_stream.h"
#include "core/volume/segment_stream.h"

namespace aerosol::render {

struct PreparedScene;

/// Keeps its memory from ray to ray.
class PathSpans final : public volume::SpanSource {
 public:
  /// Spans of surface-defined media, to be filled before `begin`: ascending and disjoint.
  std::vector<volume::MediumSpan>& boundary() { return boundary_; }
  /// Stretches without volume primitives, likewise; their media mean nothing.
  std::vector<volume::MediumSpan>& clipped() { return clipped_; }

  /// `media` are those of the volumes, by accel::VolumeId. `found` is what the ray's query gave; it stays until the
  /// last span was taken.
  void begin(const PreparedScene& scene, std::span<const volume::Medium* const> media, const Ray<World>& ray, double t0,
             double t1, std::span<const accel::Span> found, accel::Counters& counters);

  /// Of a span among those that `begin` was given.
  const volume::Medium& mediumOf(const accel::Span& span) const { return *media_[span.volume]; }

  /// In the order of t0; of spans that start together the surface-defined one first. Not for rays of which a part is
  /// clipped, and another not.
  const volume::MediumSpan* peek(double limit) override;
  void pop() override;

  /// Any span that is left, in no particular order; false when there is none.
  bool take(volume::MediumSpan& span);

 private:
  std::span<const volume::Medium* const> media_;  ///< By accel::VolumeId.
  std::vector<volume::MediumSpan> boundary_, clipped_;
  std::size_t nextBoundary_ = 0;
  bool boundaryIsNext_ = false;
  accel::SpanStream volumes_;
  volume::MediumSpan current_;
  bool hasRest_ = false;  ///< `current_` is what is left of a span that was cut.
};

}  // namespace aerosol::render

// From overlapping spans to disjoint segments with a constant set of media (talk: "sort and split").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/volume/medium.h"

namespace aerosol::volume {

/// Where a ray is inside one medium: t0 <= t1, distances along the ray. Double, because a float cannot tell apart the
/// two sides of a small volume that is a million of its sizes away.
struct MediumSpan {
  double t0 = 0;
  double t1 = 0;
  const Medium* medium = nullptr;
};

/// A part of a ray in which the set of media does not change.
struct Segment {
  double t0 = 0;
  double t1 = 0;
  std::span<const Medium* const> media;
};

/// Disjoint segments in order along the ray. Keeps its memory between rays.
class SegmentList {
 public:
  /// Splits spans at each other's ends. Spans of zero length vanish; gaps between segments are empty space. Media of a
  /// segment stand in the order of the spans given.
  void assign(std::span<const MediumSpan> spans);

  std::span<const Segment> segments() const { return segments_; }

 private:
  std::vector<std::uint32_t> starts_, ends_;  ///< Indices of spans, by t0 and by t1.
  std::vector<std::uint32_t> active_;         ///< Those around the current place, ascending.
  std::vector<const Medium*> media_;
  std::vector<std::uint32_t> mediaEnds_;  ///< By segment.
  std::vector<Segment> segments_;
};

}  // namespace aerosol::volume

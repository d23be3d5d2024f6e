// From overlapping spans to disjoint segments with a constant set of media (talk: "sort and split"), as far as asked.
#pragma once

#include <vector>

#include "core/volume/segments.h"

namespace aerosol::volume {

/// Spans along a ray in the order of t0; those that start at one place in an order of their own that is always the
/// same.
class SpanSource {
 public:
  virtual ~SpanSource() = default;
  /// The next span if it starts before `limit`; null otherwise. t0 < t1. Valid until `pop`.
  virtual const MediumSpan* peek(double limit) = 0;
  virtual void pop() = 0;
};

/// Segments one by one, front to back. Gaps between them are empty space. Media of a segment stand in the order in
/// which the spans came. Nothing is asked of the source that lies behind the current segment, so whoever stops early
/// saves the rest. Memory and time are in proportion to the spans at one place; both kept from ray to ray.
class SegmentStream {
 public:
  /// `source` stays until the last segment was taken.
  void begin(SpanSource& source);
  /// Of a ray without any span.
  void beginEmpty() { source_ = nullptr; }
  /// There has been no span at all. False does not say that there is one.
  bool isEmpty() const { return source_ == nullptr; }
  /// False behind the last segment. The segment's media are valid until the next call.
  bool next(Segment& segment);

 private:
  SpanSource* source_ = nullptr;
  double t_ = 0;
  std::vector<MediumSpan> active_;
  std::vector<const Medium*> media_;
};

}  // namespace aerosol::volume

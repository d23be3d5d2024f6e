// The volume spans of a ray one by one, front to back, found as far as somebody asks.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/accel/scene.h"

namespace aerosol::accel {

/// Spans of a ray in the order of (t0, volume), by one of two designs:
/// - split: the ray's query has found all of them, and they are sorted;
/// - partition (talk: "aggregate volumes", after Fong, Wrenninge, Kulla and Habel 2017, "Production Volume Rendering"):
///   regions of a kd-tree are walked front to back; a primitive is tested when the first region that lists it is
///   entered, and a span is given out when no region that is still to come can hold an earlier one. Whoever stops
///   asking (the path has scattered) saves the rest of the way.
///
/// Both give the same spans, bit by bit, but for this: where a partition knows that regions are empty of a volume, a
/// span begins only where the first region is entered that is not, or is missing.
///
/// Keeps its memory from ray to ray.
class SpanStream {
 public:
  /// All spans are known, in order; they stay where they are until the last was taken.
  void begin(std::span<const Span> sorted);
  /// Walks the scene's partition between t0 and t1 of the ray. The counters stay in use.
  void begin(const Scene& scene, const Ray<World>& ray, double t0, double t1, Counters& counters);

  /// The next span if it starts before `limit`; null otherwise. Stays valid until `pop`.
  const Span* peek(double limit = std::numeric_limits<double>::infinity()) {
    if (next_ == end_ && scene_) advance(limit);
    return next_ != end_ && next_->t0 < limit ? next_ : nullptr;
  }
  void pop() { ++next_; }

 private:
  struct Visit {
    std::uint32_t node = 0;
    double t0 = 0, t1 = 0;
  };
  class Recorder;

  void advance(double limit);
  void visitNext();
  void openLeaf(std::span<const VolumeId> volumes, double t0);
  void test(VolumeId volume, double from);
  bool isNew(VolumeId volume);
  void growTable();

  const Span* next_ = nullptr;
  const Span* end_ = nullptr;

  // Of a walk:
  const Scene* scene_ = nullptr;  ///< Null when all spans are known.
  Counters* counters_ = nullptr;
  Ray<World> ray_;
  std::array<double, 3> origin_{}, direction_{}, inverse_{};
  double from_ = 0, to_ = 0;
  double reached_ = 0;  ///< No span that is not found yet starts before.
  std::vector<Visit> stack_;
  std::vector<Span> found_;  ///< A heap, the first span on top.
  Span current_;             ///< Taken off it.
  // Primitives that were tested: a hash table with open addressing.
  std::vector<std::uint32_t> table_;
  std::vector<std::uint32_t> used_;  ///< Occupied places of it.
};

}  // namespace aerosol::accel

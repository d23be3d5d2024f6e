// Where a volume primitive is: the intervals in which a line is inside.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/geometry.h"

namespace aerosol::accel {

/// An interval of ray distances; t0 <= t1. Double, because a float cannot tell apart the two sides of a small volume
/// that is a million of its sizes away.
struct Interval {
  double t0 = 0, t1 = 0;

  friend bool operator==(const Interval&, const Interval&) = default;
};

/// Who takes the intervals of a line.
class IntervalSink {
 public:
  virtual void add(const Interval& interval) = 0;

 protected:
  ~IntervalSink() = default;
};

/// A list of intervals, for tests and tools.
class IntervalList final : public IntervalSink, public std::vector<Interval> {
 public:
  void add(const Interval& interval) override { push_back(interval); }
};

/// What a line meets. Implementations are immutable, deterministic, safe to call from any thread, and throw nothing.
class VolumeShape {
 public:
  virtual ~VolumeShape() = default;

  /// A box that holds the volume. Infinite where the volume is: such a volume is tested against every ray.
  virtual Box<World> worldBounds() const = 0;
  /// The same in the primitive's own space, that of its shader.
  virtual Box<Object> objectBounds() const { return {{-1, -1, -1}, {1, 1, 1}}; }

  /// Gives where the infinite line `ray.origin + t * ray.direction` is inside: ascending, disjoint, t0 < t1. Nothing
  /// where it misses or touches in one point. `ray.tMin` and `ray.tMax` are not looked at: the origin may be inside or
  /// behind, then t0 < 0. Ends may be infinite. False when the shape is open along this line (a mesh with a hole):
  /// then what is given is the shape's documented guess.
  virtual bool intersect(const Ray<World>& ray, IntervalSink& intervals) const = 0;
};

/// A volume that meets any line in one interval.
class ConvexVolume : public VolumeShape {
 public:
  /// Nothing when the line misses or touches in one point.
  virtual std::optional<Interval> intersect(const Ray<World>& ray) const = 0;

  bool intersect(const Ray<World>& ray, IntervalSink& intervals) const final {
    if (const auto interval = intersect(ray); interval && interval->t0 < interval->t1) intervals.add(*interval);
    return true;
  }
};

}  // namespace aerosol::accel

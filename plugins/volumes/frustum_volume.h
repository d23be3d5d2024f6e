// Where voxels are that stand in a frustum.
#pragma once

#include <cmath>
#include <limits>

#include "core/accel/double3.h"
#include "core/accel/volume_shape.h"
#include "core/grid/kd_tree.h"
#include "core/grid/overlay_grid.h"

namespace aerosol::render {

/// The blocks around active voxels. Their planes are brought to world space as the ray meets them; or cells of a
/// regular grid laid over them stand for them.
class FrustumVolume final : public accel::VolumeShape {
 public:
  /// `map` is from the file's space. `overlayCells` along the longest side; 0: the blocks themselves.
  FrustumVolume(const Transform<World, Object>& toWorld, const VoxelMap& map, grid::KdTree blocks, int overlayCells)
      : worldToFile_(toWorld.inverseMatrix()), map_(map.after(worldToFile_)), blocks_(std::move(blocks)) {
    if (overlayCells > 0) overlay_ = grid::OverlayGrid(blocks_, map, overlayCells);
    worldBounds_ = boxOf<World>(map_, blocks_);
    objectBounds_ = boxOf<Object>(map, blocks_);
  }

  Box<World> worldBounds() const override { return worldBounds_; }
  Box<Object> objectBounds() const override { return objectBounds_; }
  bool intersect(const Ray<World>& ray, accel::IntervalSink& intervals) const override {
    Taker taker(intervals);
    const accel::Double3 o = accel::toDouble(ray.origin), d = accel::toDouble(ray.direction);
    if (overlay_.empty()) {
      blocks_.walk(grid::LineToGrid(map_, {o.x, o.y, o.z}, {d.x, d.y, d.z}), taker);
    } else {
      const accel::Double3 a = accel::mapPoint(worldToFile_, o), b = accel::mapVector(worldToFile_, d);
      overlay_.walk({a.x, a.y, a.z}, {b.x, b.y, b.z}, taker);
    }
    return true;
  }

 private:
  class Taker final : public grid::IntervalTaker {
   public:
    explicit Taker(accel::IntervalSink& sink) : sink_(sink) {}
    void add(double t0, double t1) override { sink_.add({t0, t1}); }

   private:
    accel::IntervalSink& sink_;
  };

  template <class Space>
  static Box<Space> boxOf(const VoxelMap& map, const grid::KdTree& blocks) {
    VoxelMap::Triple lower, upper;
    map.fileBox(blocks.lower(), blocks.upper(), lower, upper);
    Box<Space> box;
    for (int r = 0; r < 3; ++r) {
      const auto i = static_cast<std::size_t>(r);
      // A corner is where three planes meet: found to a few roundings.
      const double slack = 1e-9 * (upper[i] - lower[i] + std::fabs(lower[i]) + std::fabs(upper[i]));
      box.lower[r] = std::nextafter(static_cast<float>(lower[i] - slack), -std::numeric_limits<float>::infinity());
      box.upper[r] = std::nextafter(static_cast<float>(upper[i] + slack), std::numeric_limits<float>::infinity());
    }
    return box;
  }

  Matrix4 worldToFile_;
  VoxelMap map_;  ///< From world space.
  grid::KdTree blocks_;
  grid::OverlayGrid overlay_;
  Box<World> worldBounds_;
  Box<Object> objectBounds_;
};

}  // namespace aerosol::render

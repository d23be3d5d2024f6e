#include "core/render/carried_volume.h"

namespace aerosol::render {

namespace {

/// From the cube [-1, 1]³ to a box.
Transform<World, Object> onBox(const Transform<World, Object>& toWorld, const Box<Object>& box) {
  Matrix4 place = identityMatrix(), inverse = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto lower = static_cast<double>(box.lower[static_cast<int>(i)]);
    const auto upper = static_cast<double>(box.upper[static_cast<int>(i)]);
    place[i][i] = 0.5 * (upper - lower);
    place[i][3] = 0.5 * (upper + lower);
    inverse[i][i] = 1 / place[i][i];
    inverse[i][3] = -place[i][3] / place[i][i];
  }
  return {multiply(toWorld.matrix(), place), multiply(inverse, toWorld.inverseMatrix())};
}

class ContainsOrigin final : public accel::IntervalSink {
 public:
  void add(const accel::Interval& interval) override { found = found || (interval.t0 <= 0 && interval.t1 > 0); }
  bool found = false;
};

}  // namespace

CarriedVolume::CarriedVolume(std::unique_ptr<const accel::VolumeShape> atReference,
                             const Transform<World, Object>& toWorld, const Box<Object>& reach)
    : atReference_(std::move(atReference)), toWorld_(toWorld), reach_(reach), box_(onBox(toWorld, reach)) {}

bool CarriedVolume::held(Point<Object> point) const {
  Ray<World> ray;
  ray.origin = toWorld_(point);
  // Along no axis and no diagonal: in the plane of few faces.
  ray.direction = {0.30f, 0.52f, 0.80f};
  ContainsOrigin sink;
  atReference_->intersect(ray, sink);
  return sink.found;
}

}  // namespace aerosol::render

#include "core/render/aov/seen_motion.h"

#include <cmath>

#include "core/render/aov/path_record.h"
#include "core/render/prepared_scene.h"

namespace aerosol::render {

namespace {

/// Where the camera of a time sees a point, in pixels from the film's upper left corner; nothing behind it.
std::optional<std::array<double, 2>> seenAt(const Camera& camera, Point<World> point, float time) {
  const Point<aerosol::Camera> p = camera.toWorld(time).inverse()(point);
  const shading::CameraProjection projection = camera.projection();
  const auto apply = [](const Matrix4& m, const std::array<double, 4>& v) {
    std::array<double, 4> result{};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) result[i] += m[i][j] * v[j];
    }
    return result;
  };
  auto screen =
      apply(projection.toScreen, {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z), 1});
  if (!(screen[3] > 0)) return {};
  for (double& value : screen) value /= screen[3];
  const auto ndc = apply(projection.screenToNdc, screen);
  return std::array{ndc[0] * projection.width, ndc[1] * projection.height};
}

/// `placeAt(time)`: where it is.
template <class PlaceAt>
std::array<float, 2> fromOpenToClose(const PreparedScene& scene, PlaceAt&& placeAt) {
  const auto from = seenAt(*scene.camera, placeAt(scene.shutter.open), scene.shutter.open);
  const auto to = seenAt(*scene.camera, placeAt(scene.shutter.close), scene.shutter.close);
  if (!from || !to) return {};
  return {static_cast<float>((*to)[0] - (*from)[0]), static_cast<float>((*to)[1] - (*from)[1])};
}

}  // namespace

std::array<float, 2> motionOf(const PathContext& path, const accel::SurfaceHit& hit, float time) {
  const auto& motion = path.record->plan().objectMotions[hit.object];
  return fromOpenToClose(path.scene(), [&](float when) {
    return motion ? motion->at(when)(motion->at(time).inverse()(hit.point)) : hit.point;
  });
}

/// What is at x at a time was at x - (time - reference) v(x) at the reference time, where v is that of the place where
/// it is now (MediumVelocity): straight on with the same velocity it passes through the shutter.
std::array<float, 2> motionOf(const PathContext& path, const volume::Medium& medium, Point<World> point, float time,
                              Vector<World> velocity) {
  const PreparedScene& scene = path.scene();
  const MediumVelocity* const moves = scene.velocityOf(medium.index);
  const auto& motion = scene.shading.instance(scene.mediumShaders[medium.index]).motion;
  const bool isFinite = std::isfinite(velocity.x + velocity.y + velocity.z);
  const auto way = [&](float when) {
    return moves && isFinite ? velocity * (moves->factor * (when - moves->referenceTime)) : Vector<World>();
  };
  const Point<World> atReference = point - way(time);
  return fromOpenToClose(scene, [&](float when) {
    return (motion ? motion->at(when)(motion->at(time).inverse()(atReference)) : atReference) + way(when);
  });
}

}  // namespace aerosol::render

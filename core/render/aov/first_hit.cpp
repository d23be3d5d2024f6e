#include "core/render/aov/first_hit.h"

#include <array>
#include <limits>

#include "core/render/aov/path_record.h"
#include "core/render/aov/seen_motion.h"
#include "core/render/prepared_scene.h"
#include "core/render/surface_closures.h"

namespace aerosol::render {

namespace {

template <class Three>
std::array<float, 3> threeOf(const Three& v) {
  return {v.x, v.y, v.z};
}

/// All but the albedo.
void recordGeometry(PathContext& path, const CameraSample& camera, const Ray<World>& ray, const accel::SurfaceHit& hit,
                    const AovPlan::FeatureSlot& slot) {
  using F = AovFeature;
  const auto set = [&](const auto& values) { path.record->set(slot.slot, values); };
  const auto footprint = [&] {
    constexpr float unlimited = std::numeric_limits<float>::max();
    return footprintOn(path.scene().camera->footprint(camera), hit, unlimited);
  };
  switch (slot.feature) {
    case F::depth:
      return set(std::array{static_cast<float>(hit.t)});
    case F::position:
      return set(threeOf(hit.point));
    case F::uv:
      return set(std::array{hit.u, hit.v});
    case F::geometricNormal:
      return set(threeOf(hit.geometricNormal));
    case F::shadingNormal:
      return set(threeOf(hit.shadingNormal));
    case F::dPdu:
      return set(threeOf(hit.dPdu));
    case F::dPdv:
      return set(threeOf(hit.dPdv));
    case F::dUVdx:
      return set(footprint().uv_x);
    case F::dUVdy:
      return set(footprint().uv_y);
    case F::primitiveIndex:
      return set(std::array{static_cast<float>(hit.primitive)});
    case F::shapeIndex:
      return set(std::array{static_cast<float>(hit.object + 1)});
    case F::motion:
      return set(motionOf(path, hit, ray.time));
    default:
      return;
  }
}

}  // namespace

volume::Task<> recordFirstHit(PathContext& path, CameraSample camera, Ray<World> ray) {
  const PreparedScene& scene = path.scene();
  const auto& slots = path.record->plan().firstHit;
  if (slots.empty()) co_return;
  const auto hit = scene.geometry->closestHit(ray, path.spans, path.statistics().accel, nullptr, shading::ray::camera);
  if (!hit) co_return;
  for (const AovPlan::FeatureSlot& slot : slots) {
    if (slot.feature != AovFeature::albedo) {
      recordGeometry(path, camera, ray, *hit, slot);
      continue;
    }
    const PreparedObject& object = scene.objects[hit->object];
    if (object.isBoundary) continue;
    path.setRay(ray);
    const shading::ShadingPoint point = shadingPointOf(path, *hit, ray);
    co_await path.shade(object.material, point);
    const SurfaceClosures closures(object, path.surfaceAnswer(), *hit, ray.direction);
    const Color albedo = closures.mix().albedo();
    path.record->set(slot.slot, std::array{albedo.r, albedo.g, albedo.b});
  }
}

}  // namespace aerosol::render

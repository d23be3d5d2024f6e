#include "core/render/media_probe.h"

#include <algorithm>
#include <optional>

#include "core/render/interior.h"
#include "core/render/nesting.h"
#include "core/render/prepared_scene.h"
#include "core/render/surface_closures.h"

namespace aerosol::render {

volume::Task<bool> probeMedia(PathContext& path, Point<World> point, float time) {
  const PreparedScene& scene = path.scene();
  path.statistics().work.add(Work::probe);
  Ray<World> up;
  up.origin = point;
  up.direction = {0, 1, 0};
  up.time = time;
  Ray<World> down = up;
  down.direction = {0, -1, 0};
  path.probed.clear();
  std::optional<accel::HitKey> last;
  while (const auto hit =
             scene.geometry->closestHit(up, path.spans, path.statistics().accel, last ? &*last : nullptr)) {
    path.probed.push_back(*hit);
    last = hit->key();
  }
  turnDownwards(path.probed);
  path.media.clear();
  volume::StackStatistics ignored;
  for (std::size_t i = 0; i < path.probed.size(); ++i) {
    const accel::SurfaceHit hit = path.probed[i];
    const PreparedObject& object = scene.objects[hit.object];
    std::optional<volume::Interior> interior;
    if (object.isBoundary) {
      interior = boundaryInterior(scene, hit.object);
    } else {
      const shading::ShadingPoint where = shadingPointOf(scene, hit, down);
      interior = interiorOf(scene, hit.object, co_await path.shade(object.material, where));
    }
    if (interior) path.media.cross(*interior, !hit.entering, ignored);
  }
  co_return true;
}

bool needsProbes(const PreparedScene& scene, Point<World> eye, float reach) {
  const auto isNear = [&](const Box<World>& box) {
    for (int i = 0; i < 3; ++i) {
      if (box.lower[i] > eye[i] + reach || box.upper[i] < eye[i] - reach) return false;
    }
    return true;
  };
  for (std::uint32_t i = 0; i < scene.geometry->objectCount(); ++i) {
    const accel::TriangleMesh* const mesh = scene.geometry->mesh(i);
    if (!mesh || scene.geometry->sharedPlacement(i)) {
      if (isNear(scene.geometry->surfaceBounds(i))) return true;
      continue;
    }
    for (const auto& triangle : mesh->triangles) {
      Box<World> box;
      for (const std::uint32_t corner : triangle) box.extend(mesh->positions[corner]);
      if (isNear(box)) return true;
    }
  }
  return false;
}

}  // namespace aerosol::render

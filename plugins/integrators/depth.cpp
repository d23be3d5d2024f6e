// The distance from the near clip plane to the first surface, as a picture (as Mitsuba measures it): to look at
// geometry before there is light.

#include "core/render/prepared_scene.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

using volume::Task;

Task<Radiance> measureDepth(PathContext& path, Ray<World> ray) {
  const auto hit =
      path.scene().geometry->closestHit(ray, path.spans, path.statistics().accel, nullptr, shading::ray::camera);
  co_return hit ? Radiance{Color(static_cast<float>(hit->t) - ray.tMin), 1} : Radiance{};
}

class DepthIntegrator final : public Integrator {
 public:
  Task<Radiance> trace(PathContext& path, const Ray<World>& cameraRay) const override {
    return measureDepth(path, cameraRay);
  }
};

}  // namespace

void registerIntegrator_depth(Registry& registry) {
  registry.add(NamedIntegrator{.name = "depth",
                               .doc = "Distance from the near clip plane to the first surface",
                               .integrator = std::make_shared<const DepthIntegrator>()});
}

}  // namespace aerosol::render

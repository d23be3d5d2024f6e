// A ball-shaped volume primitive.

#include "core/accel/convex_volume.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

Transform<World, Object> place(const scene::Volume& volume) {
  const auto center = volume.get<Point<scene::Unplaced>>("center");
  return ballPlacement(volume.toWorld, Point<Object>(center.x, center.y, center.z), volume.get<float>("radius"));
}

Result<std::unique_ptr<const accel::VolumeShape>> make(const VolumeArguments& arguments) {
  return {std::make_unique<accel::SphereVolume>(arguments.toWorld)};
}

}  // namespace

void registerVolume_sphere(Registry& registry) {
  registry.add(VolumeType{.described = {.type = "sphere",
                                        .doc = "a ball filled with a medium",
                                        .parameters = {{.name = "center",
                                                        .type = scene::ValueType::point,
                                                        .unit = "scene units",
                                                        .doc = "centre, in the primitive's own space",
                                                        .defaultValue = Point<scene::Unplaced>(0, 0, 0)},
                                                       {.name = "radius",
                                                        .type = scene::ValueType::number,
                                                        .unit = "scene units",
                                                        .doc = "radius, in the primitive's own space",
                                                        .defaultValue = 1.0f,
                                                        .range = scene::Range::positive()}}},
                          .place = place,
                          .make = make});
}

}  // namespace aerosol::render

// A ball-shaped volume primitive.

#include "core/render/registry.h"

namespace aerosol::render {

namespace {

std::unique_ptr<const accel::ConvexVolume> make(const scene::Volume& volume) {
  const auto center = volume.get<Point<scene::Unplaced>>("center");
  const double radius = volume.get<float>("radius");
  Matrix4 place = identityMatrix();
  Matrix4 inverse = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    place[i][i] = radius;
    place[i][3] = center[static_cast<int>(i)];
    inverse[i][i] = 1 / radius;
    inverse[i][3] = -place[i][3] / radius;
  }
  return std::make_unique<accel::SphereVolume>(Transform<World, Object>(
      multiply(volume.toWorld.matrix(), place), multiply(inverse, volume.toWorld.inverseMatrix())));
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
                          .make = make});
}

}  // namespace aerosol::render

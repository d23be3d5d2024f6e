// A box-shaped volume primitive: [-1, 1] on each axis of its own space.

#include "core/render/registry.h"

namespace aerosol::render {

void registerVolume_box(Registry& registry) {
  registry.add(
      VolumeType{.described = {.type = "box", .doc = "The cube from -1 to 1 on each axis of its own space"},
                 .place = [](const scene::Volume& volume) { return volume.toWorld; },
                 .make = [](const Transform<World, Object>& toWorld) -> std::unique_ptr<const accel::ConvexVolume> {
                   return std::make_unique<accel::BoxVolume>(toWorld);
                 }});
}

}  // namespace aerosol::render

// A box-shaped volume primitive: [-1, 1] on each axis of its own space.

#include "core/render/registry.h"

namespace aerosol::render {

void registerVolume_box(Registry& registry) {
  registry.add(VolumeType{.described = {.type = "box", .doc = "The cube from -1 to 1 on each axis of its own space"},
                          .make = [](const scene::Volume& volume) -> std::unique_ptr<const accel::ConvexVolume> {
                            return std::make_unique<accel::BoxVolume>(volume.toWorld);
                          }});
}

}  // namespace aerosol::render

// A box-shaped volume primitive: [-1, 1] on each axis of its own space.

#include "core/accel/convex_volume.h"
#include "core/render/registry.h"

namespace aerosol::render {

void registerVolume_box(Registry& registry) {
  registry.add(
      VolumeType{.described = {.type = "box", .doc = "The cube from -1 to 1 on each axis of its own space"},
                 .place = [](const scene::Volume& volume) { return volume.toWorld; },
                 .make = [](const VolumeArguments& arguments) -> Result<std::unique_ptr<const accel::VolumeShape>> {
                   return {std::make_unique<accel::BoxVolume>(arguments.toWorld)};
                 }});
}

}  // namespace aerosol::render

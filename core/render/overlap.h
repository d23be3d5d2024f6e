// What bounds on density tell the partition of volume primitives.
#pragma once

#include "core/render/prepared_scene.h"

namespace aerosol::render {

/// Where the scene's volume primitives are partitioned: leaves them out of regions in which there is surely nothing of
/// their medium. To be called when the media's bounds are there.
void partitionVolumes(PreparedScene& scene);

}  // namespace aerosol::render

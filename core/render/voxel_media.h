// Finds the media whose coefficients are voxels times constants: these have closed forms.
#pragma once

#include <cstdint>
#include <functional>

#include "core/render/prepared_scene.h"

namespace aerosol::render {

/// Gives a voxel field to each medium that `isWanted` asks about and that turns out to be one: its program, with the
/// instance's parameters, is a lookup of a grid at P in object space times constants, it leaves no messages, and does
/// not move by a velocity. Media that read the same grid share it; media are taken in order while the copies of all
/// voxels fit into `largestBytes`.
void findVoxelMedia(PreparedScene& scene, const std::function<bool(std::uint32_t)>& isWanted,
                    std::uint64_t largestBytes);

}  // namespace aerosol::render

// The velocities that blur volumes, as a scene is prepared.
#pragma once

#include "core/render/carried_matter.h"
#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Finds the shader that gives a volume's velocity: the medium's own, or one that reads a grid.
void placeVelocity(Preparation& state, const scene::Volume& volume, std::uint32_t medium);

/// What its grid of velocities carries while the shutter is open; nothing without one.
CarriedMatter carriedBy(Preparation& state, const scene::Volume& volume);

/// The primitive of a volume, made from `placed`, with room for what velocities carry out of it; as it is where there
/// are none. `hasRoom`: it has room for what a grid carries.
std::unique_ptr<const accel::VolumeShape> carry(Preparation& state, const scene::Volume& volume, std::uint32_t medium,
                                                const Transform<World, Object>& placed, bool hasRoom,
                                                std::unique_ptr<const accel::VolumeShape> shape);

}  // namespace aerosol::render

// The shape of a picture that a light projects.
#pragma once

#include <optional>

#include "core/scene/description.h"
#include "core/shading/services.h"

namespace aerosol::render {

/// Width over height of the image that an emitter's texture of type bitmap shows; nothing for other textures, and when
/// the image cannot be read (its shader will say so).
std::optional<float> pictureAspect(const scene::SceneDescription& description, const scene::Emitter& emitter,
                                   shading::Services& services);

}  // namespace aerosol::render

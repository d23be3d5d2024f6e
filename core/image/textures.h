// The texture system: images filtered for shaders.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/base/texture_source.h"

namespace aerosol::image {

/// Textures of one scene, with a cache of their own. Loads the image libraries. An error when the settings make no
/// sense.
Result<std::unique_ptr<TextureSource>> openTextures(const TextureSettings& settings);

}  // namespace aerosol::image

// Pictures in the channels that a film asks for.
#pragma once

#include "core/image/image.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// A picture of linear Rec.709 light in channels R, G, B and, if the format has it, A, as the format's channels: Y,
/// relative luminance; X, Y and Z, CIE 1931. Layers and what else comes with it stay.
image::ImageBuffer inFormat(const image::ImageBuffer& picture, scene::PixelFormat format);

}  // namespace aerosol::app

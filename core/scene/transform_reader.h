// `<transform>`: a product of translations, rotations, scalings, views and matrices.
#pragma once

#include <optional>

#include "core/base/geometry.h"
#include "core/base/motion.h"
#include "core/scene/attributes.h"

namespace aerosol::scene {

/// The product of the element's children, the first one applied first. None when something was reported.
std::optional<Matrix4> readTransform(const XmlElement& xml, ReadContext context);

/// The transforms of an `<animation>`, in order of time, each with an attribute `time` (seconds). None when something
/// was reported.
std::optional<std::vector<MotionKey>> readAnimation(const XmlElement& xml, ReadContext context);

}  // namespace aerosol::scene

// Objects inside of groups that are placed themselves.
#pragma once

#include <optional>
#include <string>

#include "core/base/geometry.h"
#include "core/scene/placement.h"

namespace aerosol::scene {

/// Places what is in a group as the group is: `inner` is applied first. What keeps the two from being one motion, which
/// would be interpolated differently; nothing when all went well.
std::optional<std::string> placeInGroup(const Placement<World, Object>& group, Placement<World, Object>& inner);

}  // namespace aerosol::scene

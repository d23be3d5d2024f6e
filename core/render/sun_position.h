// Where the sun stands.
#pragma once

#include "core/base/geometry.h"
#include "core/scene/description.h"

namespace aerosol::render {

/// The unit direction towards the sun by place and time (`SunPlace::direction` is not looked at): +z is the zenith, -x
/// north, -y east, as in Mitsuba 3. To half a minute of arc from 1999 to 2015; the same formulas serve for other years
/// of the century.
Vector<Object> sunDirection(const scene::SunPlace& place);

}  // namespace aerosol::render

// Polygons into triangles. Internal to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace aerosol::accel {

/// Appends the corners.size() - 2 triangles of a simple polygon, as indices into `corners`, in its winding. Concave
/// ones are cut right; polygons that cross themselves or have no area get triangles too, in no particular shape.
void triangulate(std::span<const Point<World>> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Concave polygons with more corners than this are refused by the loaders: cutting takes quadratic time and more.
constexpr std::size_t mostCorners = 10'000;

}  // namespace aerosol::accel

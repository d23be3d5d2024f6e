// Fibres: hair, fur, grass.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace aerosol::accel {

enum class CurveBasis : std::uint8_t {
  linear,  ///< Straight pieces from point to point, cones with balls at the points.
  bSpline  ///< Uniform cubic B-splines; a circle of the radius is swept along them. They do not reach their ends.
};

/// Where a control point stands, and the fibre's radius there.
struct CurvePoint {
  Point<World> position;
  float radius = 0;
};

/// Fibres in world space. A segment begins at point `segments[i]` and uses the two or four points from there on.
struct CurveSet {
  CurveBasis basis = CurveBasis::bSpline;
  std::vector<CurvePoint> points;
  std::vector<std::uint32_t> segments;
  std::vector<std::array<float, 2>> along;  ///< By segment: how far along its fibre it begins and ends, from 0 to 1.

  std::size_t pointsOfSegment() const { return basis == CurveBasis::linear ? 2 : 4; }
};

/// Reads a text file as Mitsuba's curves are: a line of x, y, z and radius for each point, an empty line between two
/// fibres. Positions go through `toWorld`, radii are those of the world. Errors name file, line and column.
Result<CurveSet> loadCurves(const std::string& path, CurveBasis basis, const Transform<World, Object>& toWorld);

}  // namespace aerosol::accel

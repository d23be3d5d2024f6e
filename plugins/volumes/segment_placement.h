// Volume primitives that are given by a segment and a radius: cylinder and cone.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/render/registry.h"

namespace aerosol::render {

/// Parameters p0, p1 and radius, of which `p0Doc` and `p1Doc` say what the points are.
inline std::vector<scene::ParameterSpec> segmentParameters(std::string p0Doc, std::string p1Doc,
                                                           std::string radiusDoc) {
  return {{.name = "p0",
           .type = scene::ValueType::point,
           .unit = "scene units",
           .doc = std::move(p0Doc),
           .defaultValue = Point<scene::Unplaced>(0, 0, 0)},
          {.name = "p1",
           .type = scene::ValueType::point,
           .unit = "scene units",
           .doc = std::move(p1Doc),
           .defaultValue = Point<scene::Unplaced>(0, 0, 1)},
          {.name = "radius",
           .type = scene::ValueType::number,
           .unit = "scene units",
           .doc = std::move(radiusDoc),
           .defaultValue = 1.0f,
           .range = scene::Range::positive()}};
}

/// From the canonical primitive: the axis from z = -1 (p0) to z = 1 (p1), radius 1 in x and y.
inline Transform<World, Object> placeOnSegment(const scene::Volume& volume) {
  const auto p0 = volume.get<Point<scene::Unplaced>>("p0"), p1 = volume.get<Point<scene::Unplaced>>("p1");
  const float radius = volume.get<float>("radius");
  const Vector<scene::Unplaced> axis = p1 - p0;
  const Frame<scene::Unplaced> frame(normalize(axis));
  Matrix4 place = identityMatrix(), inverse = identityMatrix();
  for (int i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(i);
    place[row] = {static_cast<double>(radius) * static_cast<double>(frame.x[i]),
                  static_cast<double>(radius) * static_cast<double>(frame.y[i]), 0.5 * static_cast<double>(axis[i]),
                  0.5 * (static_cast<double>(p0[i]) + static_cast<double>(p1[i]))};
  }
  invert(place, inverse);
  return {multiply(volume.toWorld.matrix(), place), multiply(inverse, volume.toWorld.inverseMatrix())};
}

/// Why the primitive has no extent; nothing when it has one.
inline std::optional<Diagnostic> findSegmentDefect(const scene::Volume& volume) {
  if (!(volume.get<Point<scene::Unplaced>>("p0") == volume.get<Point<scene::Unplaced>>("p1"))) return {};
  Diagnostic error;
  error.message = "'p0' and 'p1' are the same point";
  return error;
}

}  // namespace aerosol::render

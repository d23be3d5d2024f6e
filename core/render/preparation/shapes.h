// Shapes and volumes in the geometry, as a scene is prepared.
#pragma once

#include "core/render/light_surface.h"
#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Of a shape that is fibres.
accel::CurveBasis curveBasis(const scene::Shape& shape);

void addShapes(Preparation& state);
void addVolumes(Preparation& state);

void buildGeometry(Preparation& state);

/// What of the shape shines, in the space that moves if it does; null for a shape without area.
std::unique_ptr<const LightSurface> lightSurface(const Preparation& state, const scene::Shape& shape,
                                                 accel::ObjectId object);
/// Scene units²; 0 for a shape without area.
double areaAtOpening(const Preparation& state, const scene::Shape& shape, accel::ObjectId object);

}  // namespace aerosol::render

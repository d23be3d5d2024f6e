// Media and where they are, as a scene is prepared.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Those of volumes, of shapes and of the camera.
void placeMedia(Preparation& state);

/// Whether more than one of the shapes that separate media may be around a point, or one around the camera (`eye`, with
/// all that is within `reach`): then paths keep a stack of the interiors they are in. By their boxes; meshes of files,
/// which may have shells within shells, and what moves always may.
bool interiorsMayMeet(const Preparation& state, Point<World> eye, float reach);

/// Coefficients, bounds and methods of all, once the geometry stands and shaders are compiled.
void decideMedia(Preparation& state);

}  // namespace aerosol::render

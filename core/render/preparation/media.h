// Media and where they are, as a scene is prepared.
#pragma once

#include "core/render/preparation/state.h"

namespace aerosol::render {

/// Those of volumes, of shapes and of the camera.
void placeMedia(Preparation& state);

/// Whether more than one of the shapes that separate media may be around a point, or one around the camera (`eye`, with
/// all that is within `reach`): then paths keep a stack of the interiors they are in. By their boxes; what moves always
/// may, open surfaces, and meshes that may have shells within shells (of media given in the scene: all from files; of
/// closures: those that are no star bodies).
bool interiorsMayMeet(const Preparation& state, Point<World> eye, float reach);

/// Keeps what closures say is inside of objects, where no stack is kept. To be called when materials can be asked.
void placeBodies(Preparation& state);

/// Coefficients, bounds and methods of all, once the geometry stands and shaders are compiled.
void decideMedia(Preparation& state);

}  // namespace aerosol::render

// What can be found wrong with a prepared scene.
#pragma once

#include "core/app/pilot.h"
#include "core/base/diagnostic.h"
#include "core/render/prepared_scene.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// Holes, doubled and turned faces of meshes that bound media; faces of two bounding surfaces that coincide.
Diagnostics examineGeometry(const scene::SceneDescription& description, const render::PreparedScene& scene);

/// Steps that will not finish or are wider than the medium, bounds that make a ray dear, media without a known bound.
Diagnostics examineSampling(const scene::SceneDescription& description, const render::PreparedScene& scene);

/// Objects of the scene that nothing uses, and a scene without light.
Diagnostics examineInputs(const scene::SceneDescription& description, const render::PreparedScene& scene);

/// What happened while the pilot was rendered: NaN of shaders with the point, violated bounds, open surfaces.
Diagnostics examinePilot(const scene::SceneDescription& description, const render::PreparedScene& scene,
                         const PilotReport& pilot);

}  // namespace aerosol::app

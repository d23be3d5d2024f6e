// Scenes of Mitsuba's versions before 2, which spelled names differently.
#pragma once

#include "core/scene/xml_reader.h"

namespace aerosol::scene {

/// Rewrites an element and all below it as Mitsuba 3 does: names of parameters from camelCase (`toWorld`, `intIOR`) to
/// words with underscores (`to_world`, `int_ior`), but those of constants; `<lookAt>` to `<lookat>`; of a diffuse bsdf
/// `diffuse_reflectance` to `reflectance`; `uoffset`, `voffset`, `uscale` and `vscale` to a transform `to_uv`, which
/// moves first and scales then. Places stay those of the file.
void upgradeNames(XmlElement& element);

}  // namespace aerosol::scene

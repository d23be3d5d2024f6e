// The configurations of a study: what is rendered in several ways.
#pragma once

#include <string>
#include <vector>

#include "core/app/arguments.h"
#include "core/base/result.h"
#include "core/render/prepared_scene.h"

namespace aerosol::app {

/// One way to render the scene.
struct StudySetting {
  std::string name;
  std::vector<std::string> words;  ///< Arguments of `aerosol render` that give it.
  RenderArguments arguments;
};

/// By what the arguments vary; without that the scene as it is, where voxels have closed forms in it, null scattering,
/// where the scene allows it, and marching with several steps. `scene` is the scene as it is. Errors are about the
/// axes.
Result<std::vector<StudySetting>> studySettings(const StudyArguments& arguments, const render::PreparedScene& scene,
                                                bool allowsNullScattering);

/// Whether some medium's voxels are solved one by one.
bool hasClosedFormOfVoxels(const render::PreparedScene& scene);

/// Whether some medium's coefficients vary: otherwise there is nothing to march through.
bool hasVaryingMedium(const render::PreparedScene& scene);

}  // namespace aerosol::app

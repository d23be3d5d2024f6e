// What a medium does: known from its constant, from the code of its shader, or from ranges over its tree.
#pragma once

#include <cstdint>

#include "core/render/prepared_scene.h"

namespace aerosol::render {

enum class Answer : std::uint8_t {
  no,       ///< Proven.
  unknown,  ///< Not ruled out.
  yes       ///< As far as ranges tell.
};

struct MediumFacts {
  Answer scatters = Answer::unknown, emits = Answer::unknown;
  Answer isColoured = Answer::unknown;  ///< Extinction differs between channels.
};

MediumFacts factsOf(const PreparedScene& scene, const volume::Medium& medium);
/// Of the code alone: it holds wherever the shader is asked.
MediumFacts factsOfShader(const PreparedScene& scene, const volume::Medium& medium);

/// Size of the first volume primitive with the medium; of the scene, where surfaces bound it. World units.
float extentOf(const PreparedScene& scene, const volume::Medium& medium);

/// Steps of marching across it; 0 where it is not marched.
double stepsAcross(const PreparedScene& scene, const volume::Medium& medium);
/// The most of all media.
double mostStepsAcross(const PreparedScene& scene);

/// Steps of a ray beyond which a render does not come to an end.
inline constexpr double endlessSteps = 2e4;

}  // namespace aerosol::render

// What has to hold between the parameters of one object.
#pragma once

#include "core/scene/description.h"
#include "core/scene/reporter.h"

namespace aerosol::scene {

/// The crop lies within the film.
void checkFilm(const Film& film, Reporter& reporter);
/// near < far; no scale in `to_world`; `fov_axis` only beside `fov`.
void checkSensor(const Sensor& sensor, Reporter& reporter);
/// Gives the radius its default, which depends on the type and on `stddev`, unless it is written.
void completeFilter(ReconstructionFilter& filter);

}  // namespace aerosol::scene

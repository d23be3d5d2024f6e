// How fine the steps of ray marching must be for an image of a given error.
#pragma once

#include <atomic>

#include "core/app/scene_session.h"

namespace aerosol::app {

struct StepAccuracy {
  float stepScale = 1;
  double before =
      0;             ///< Bias with the scene's own step scale, as a part of the image's mean; 0: less than can be seen.
  double after = 0;  ///< With `stepScale`.
};

/// Whether some medium of the scene is marched, on the path's way or on that to lights.
bool marches(const render::PreparedScene& scene);

/// The largest step scale, the scene's or that over a power of two, with which the bias is at most half of the target.
/// It is found by small renders with a step and half of it, so that their difference is at least half of the bias where
/// that falls in proportion to the step or faster. Each has as many samples as are needed to see a difference so small,
/// with numbers of its own. Neither the time nor the number of threads has a say.
StepAccuracy findStepScale(SceneSession& session, double targetError, const std::atomic<bool>& stop);

}  // namespace aerosol::app

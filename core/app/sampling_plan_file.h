// Where the sampling of media is read back from.
#pragma once

#include <string>

#include "core/render/sampling_plan.h"

namespace aerosol::app {

/// The plan in an image that Aerosol has written (its metadata `aerosol:sampling`), or in a file of its lines.
Result<render::SamplingPlan> readSamplingPlan(const std::string& name);

}  // namespace aerosol::app

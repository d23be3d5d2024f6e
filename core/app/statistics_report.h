// The statistics of a render as text.
#pragma once

#include <string>
#include <vector>

#include "core/jit/object_cache.h"
#include "core/render/film.h"
#include "core/render/prepared_scene.h"
#include "core/render/renderer.h"

namespace aerosol::app {

/// Seconds that the steps in front of the render took.
struct PreparationTimes {
  double load = 0;     ///< Reading the scene.
  double prepare = 0;  ///< Shaders, geometry, lights.
};

/// How each medium is sampled and why, a line each; media of which the same is to be said share one.
std::vector<std::string> samplingOfMedia(const render::PreparedScene& scene);

/// A table for people; `threads` is how many rendered, `cache` may be null.
std::string formatStatistics(const render::PreparedScene& scene, const render::RenderReport& report,
                             const render::Film& film, const PreparationTimes& times, int threads,
                             const jit::ObjectCache* cache);

}  // namespace aerosol::app

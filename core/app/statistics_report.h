// The statistics of a render as text.
#pragma once

#include <string>

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

/// A table for people; `threads` is how many rendered, `cache` may be null.
std::string formatStatistics(const render::PreparedScene& scene, const render::RenderReport& report,
                             const render::Film& film, const PreparationTimes& times, int threads,
                             const jit::ObjectCache* cache);

}  // namespace aerosol::app

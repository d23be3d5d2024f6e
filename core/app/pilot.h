// A small render that shows what a large one will be like.
#pragma once

#include <cstdint>
#include <memory>

#include "core/app/scene_session.h"
#include "core/render/film.h"

namespace aerosol::app {

/// Makes the film, its crop with it, so small that its longer side has at most `size` pixels.
void shrinkFilm(scene::Film& film, int size);

struct PilotReport {
  render::RenderReport report;
  std::unique_ptr<render::Film> film;
  std::uint32_t samples = 0;    ///< Of a pixel.
  double processorSeconds = 0;  ///< Of all threads together.
};

/// Renders a prepared session's film, with its layers, with 1, 2, 4 … samples a pixel, 8 at least, until it took so
/// many seconds or has the most samples; profiled.
PilotReport renderPilot(const SceneSession& session, double seconds, std::uint32_t mostSamples = 1u << 12);

}  // namespace aerosol::app

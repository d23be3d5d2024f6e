// A small render that shows what a large one will be like.
#pragma once

#include <memory>

#include "core/app/scene_session.h"
#include "core/render/film.h"

namespace aerosol::app {

/// Makes the film, its crop with it, so small that its longer side has at most `size` pixels.
void shrinkFilm(scene::Film& film, int size);

struct PilotReport {
  render::RenderReport report;
  std::unique_ptr<render::Film> film;
  std::uint64_t samples = 0;  ///< Of a pixel.
};

/// Renders a prepared session's film with 1, 2, 4 … samples for at least so many seconds, profiled.
PilotReport renderPilot(const SceneSession& session, double seconds);

}  // namespace aerosol::app

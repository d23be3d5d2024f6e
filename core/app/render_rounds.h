// A render that ends when its error is small enough, or its time over.
#pragma once

#include <functional>

#include "core/render/film.h"
#include "core/render/renderer.h"

namespace aerosol::app {

/// What ends a render besides its last sample.
struct Goal {
  double error = 0;           ///< Relative, of the image; 0: none.
  double seconds = 0;         ///< For rendering; 0: none.
  std::uint32_t maximum = 0;  ///< Samples of a pixel, at most.

  explicit operator bool() const { return error > 0 || seconds > 0; }
};

struct GoalReport {
  render::RenderReport render;
  std::uint32_t samples = 0;  ///< Of each pixel, unless interrupted.
  double error = 0;           ///< Reached; 0: not known.
};

/// Renders with more and more samples and looks after fixed numbers of them (see nextDecision in film_error.h) whether
/// to go on. So the number of samples alone tells the image: rendered with that number, it is the same bit by bit.
/// Rounds that would end after the time are not begun; one sample a pixel is always rendered.
GoalReport renderTowards(const Goal& goal, const render::PreparedScene& scene, const render::Integrator& integrator,
                         render::Film& film, render::RenderOptions options);

}  // namespace aerosol::app

#include "core/app/pilot.h"

#include <algorithm>
#include <cmath>

#include "core/app/picture.h"

namespace aerosol::app {

void shrinkFilm(scene::Film& film, int size) {
  const double factor = std::min(1.0, static_cast<double>(size) / std::max(film.croppedWidth(), film.croppedHeight()));
  const auto scale = [&](int pixels) { return std::max(1, static_cast<int>(std::lround(pixels * factor))); };
  const int width = scale(film.croppedWidth()), height = scale(film.croppedHeight());
  const int x = static_cast<int>(film.cropOffsetX * factor), y = static_cast<int>(film.cropOffsetY * factor);
  film.width = std::max(scale(film.width), x + width);
  film.height = std::max(scale(film.height), y + height);
  film.cropOffsetX = x;
  film.cropOffsetY = y;
  film.cropWidth = width;
  film.cropHeight = height;
}

PilotReport renderPilot(const SceneSession& session, double seconds) {
  constexpr std::uint32_t mostSamples = 1u << 12;
  PilotReport pilot;
  pilot.film = std::make_unique<render::Film>(cropOf(session.description().film));
  render::RenderOptions options;
  options.threads = session.threadCount();
  options.endSample = 1;
  {
    // What is made at first use, such as tables of materials, is no part of what follows.
    render::Film first(pilot.film->area());
    render::render(session.scene(), session.integrator(), first, options);
  }
  options.profile = true;
  for (std::uint32_t end = 1; end <= mostSamples; end *= 2) {
    options.endSample = end;
    const render::RenderReport round = render::render(session.scene(), session.integrator(), *pilot.film, options);
    pilot.report.statistics += round.statistics;
    pilot.report.seconds += round.seconds;
    options.firstSample = end;
    pilot.samples = end;
    if (pilot.report.seconds >= seconds) break;
  }
  return pilot;
}

}  // namespace aerosol::app

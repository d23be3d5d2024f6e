#include "core/app/pilot.h"

#include <algorithm>
#include <cmath>
#include <ctime>

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

namespace {

std::unique_ptr<render::Film> filmOf(const SceneSession& session) {
  const render::AovPlan* const aovs = session.scene().aovs.get();
  return std::make_unique<render::Film>(cropOf(session.description().film), aovs ? aovs->layout : render::AovLayout{});
}

/// Of all threads of the program: other programs have no say in it.
double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

PilotReport renderPilot(const SceneSession& session, double seconds, std::uint32_t mostSamples) {
  constexpr std::uint32_t leastSamples = 8;  // Of fewer nobody knows the error.
  PilotReport pilot;
  pilot.film = filmOf(session);
  render::RenderOptions options;
  options.threads = session.threadCount();
  options.endSample = 1;
  {
    // What is made at first use, such as tables of materials, is no part of what follows.
    const auto first = filmOf(session);
    render::render(session.scene(), session.integrator(), *first, options);
  }
  options.profile = true;
  const double before = processorSeconds();
  for (std::uint32_t end = 1;; end = std::min(2 * end, mostSamples)) {
    options.endSample = end;
    const render::RenderReport round = render::render(session.scene(), session.integrator(), *pilot.film, options);
    pilot.report.statistics += round.statistics;
    pilot.report.seconds += round.seconds;
    options.firstSample = end;
    pilot.samples = end;
    if ((pilot.report.seconds >= seconds && end >= leastSamples) || end == mostSamples) break;
  }
  pilot.processorSeconds = processorSeconds() - before;
  return pilot;
}

}  // namespace aerosol::app

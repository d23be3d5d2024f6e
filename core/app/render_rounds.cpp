#include "core/app/render_rounds.h"

#include <algorithm>
#include <chrono>

#include "core/render/film_error.h"

namespace aerosol::app {

namespace {

using Clock = std::chrono::steady_clock;

/// How far a round-by-round render is: by time, or by the error still to go. Rounds double, so that both are rough.
render::Progress overall(const Goal& goal, render::Progress round, double secondsBefore, std::uint64_t samplesBefore) {
  round.seconds += secondsBefore;
  round.samples += samplesBefore;
  round.before = 0;
  double fraction = 0;
  if (goal.seconds > 0) fraction = round.seconds / goal.seconds;
  if (goal.error > 0 && round.error > 0) {
    fraction = std::max(fraction, goal.error * goal.error / (round.error * round.error));
  }
  round.fraction = std::clamp(fraction, 0.0, 0.999);
  return round;
}

}  // namespace

GoalReport renderTowards(const Goal& goal, const render::PreparedScene& scene, const render::Integrator& integrator,
                         render::Film& film, render::RenderOptions options) {
  const Clock::time_point start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const std::uint32_t firstDecision = goal.error > 0 ? render::firstErrorDecision(film.area().pixelCount()) : 0;
  const std::function<void(const render::Progress&)> show = std::move(options.progress);
  GoalReport report;
  for (std::uint32_t count = 0;;) {
    const std::uint32_t next = std::min(render::nextDecision(count), goal.maximum);
    options.endSample = next;
    const double before = elapsed();
    const std::uint64_t samplesBefore = report.render.statistics.samples;
    if (show) {
      options.progress = [&](const render::Progress& p) { show(overall(goal, p, before, samplesBefore)); };
    }
    const render::RenderReport round = render::render(scene, integrator, film, options);
    report.render.statistics += round.statistics;
    report.render.interrupted = round.interrupted;
    const double roundSeconds = elapsed() - before;
    const std::uint64_t added = round.statistics.samples;
    report.samples = count = next;
    report.error = render::relativeError(film);
    if (round.interrupted || count == goal.maximum) break;
    if (goal.error > 0 && count >= firstDecision && report.error <= goal.error) break;
    if (goal.seconds > 0) {
      const double perSample = added > 0 ? roundSeconds / static_cast<double>(added) : 0;
      const std::uint32_t then = std::min(render::nextDecision(count), goal.maximum);
      const std::uint64_t coming = options.map ? options.map->total(then) - options.map->total(count)
                                               : film.area().pixelCount() * (then - count);
      const double nextRound = perSample * static_cast<double>(coming);
      if (elapsed() + nextRound > goal.seconds) break;
    }
  }
  report.render.seconds = elapsed();
  if (show) {
    show({1, report.render.seconds, report.render.statistics.samples, 0, report.error});
  }
  return report;
}

}  // namespace aerosol::app

#include "core/app/plan/plan_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/app/picture.h"
#include "core/app/pilot.h"
#include "core/app/plan/effects.h"
#include "core/app/quantity.h"
#include "core/app/scene_session.h"

namespace aerosol::app {

namespace {

std::string row(const Effect& effect, std::size_t width, const render::WorkerStatistics& statistics) {
  const std::string share = effect.isOn && effect.share ? formatPercent(effect.share(statistics), 1) : "";
  return fmt::format("  {:<{}}  {:<3}  {:>7}  {}\n", effect.name, width, effect.isOn ? "on" : "off", share,
                     effect.reason);
}

}  // namespace

ExitCode planCommand(const PlanArguments& arguments, const Console& console) {
  SceneSession session(arguments.render, console);
  if (!session.load()) return ExitCode::badInput;
  shrinkFilm(session.description().film, arguments.size);
  if (!session.prepare()) return ExitCode::badInput;
  const PilotReport pilot = renderPilot(session, 0.5);
  const auto effects = listEffects(session.description(), session.scene());
  std::size_t width = 6;
  for (const Effect& effect : effects) width = std::max(width, effect.name.size());
  console.print(fmt::format("Effects of {}\n  {:<{}}  {:<3}  {:>7}  why\n", arguments.render.scene.filename().string(),
                            "effect", width, "", "share"));
  for (const bool isOn : {true, false}) {
    for (const Effect& effect : effects) {
      if (effect.isOn == isOn) console.print(row(effect, width, pilot.report.statistics));
    }
  }
  if (!arguments.render.without.empty()) {
    console.print("Forced off\n");
    for (const RemovableEffect& effect : removableEffects()) {
      const auto& names = arguments.render.without;
      if (std::find(names.begin(), names.end(), effect.name) == names.end()) continue;
      console.print(fmt::format("  {:<{}}  {}\n", effect.name, width, effect.consequence));
    }
  }
  console.print(
      fmt::format("Shares are of a pilot of {} at {} x {} pixels; what no row claims is the paths' own work.\n",
                  formatCount(pilot.samples, "sample"), pilot.film->area().width(), pilot.film->area().height()));
  return ExitCode::success;
}

}  // namespace aerosol::app

#include "core/app/plan/plan_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/app/cost_report.h"
#include "core/app/picture.h"
#include "core/app/pilot.h"
#include "core/app/plan/effects.h"
#include "core/app/plan/event_costs.h"
#include "core/app/plan/features.h"
#include "core/app/quantity.h"
#include "core/app/scene_session.h"
#include "core/app/statistics_report.h"

namespace aerosol::app {

namespace {

constexpr double pilotSeconds = 0.5;

/// How two renders of the same pixels differ, as parts of the first one's mean.
struct Difference {
  double ofMean = 0, errorOfMean = 0;
  double ofPixels = 0;  ///< Root mean square, without the noise of both.
  double cost = 0;      ///< Of the second one, in processor time, as a part of the first one's.
};

Difference compare(const PilotReport& before, const PilotReport& after) {
  double mean = 0, difference = 0, variance = 0, squares = 0, values = 0;
  const render::PixelRect& area = before.film->area();
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const render::PixelEstimate a = before.film->estimate(x, y), b = after.film->estimate(x, y);
      double noise = 0;
      for (int c = 0; c < 3; ++c) {
        const double d = static_cast<double>(b.color[c]) - static_cast<double>(a.color[c]);
        const double v =
            std::pow(static_cast<double>(a.standardError[c]), 2) + std::pow(static_cast<double>(b.standardError[c]), 2);
        mean += static_cast<double>(a.color[c]);
        difference += d;
        squares += d * d - v;
        noise += std::sqrt(v);
        ++values;
      }
      // Colours share their paths: their errors add up as they are.
      variance += noise * noise;
    }
  }
  const double scale = std::max(std::fabs(mean), 1e-30);
  return {difference / scale, std::sqrt(variance) / scale, std::sqrt(std::max(0.0, squares / values)) * values / scale,
          after.processorSeconds / std::max(before.processorSeconds, 1e-9)};
}

std::string percentOf(double part) {
  const double percent = 100 * std::fabs(part);
  return percent < 10 ? fmt::format("{:.2g} %", percent) : fmt::format("{:.0f} %", percent);
}

/// "12 % darker in the mean (+- 0.3 %), its pixels differ by 20 %".
std::string describe(const Difference& d) {
  const std::string error = fmt::format("(+- {:.1g} %)", 100 * d.errorOfMean);
  std::string text = std::fabs(d.ofMean) > 3 * d.errorOfMean ? fmt::format("{} {} in the mean {}", percentOf(d.ofMean),
                                                                           d.ofMean < 0 ? "darker" : "brighter", error)
                                                             : fmt::format("as bright as before in the mean {}", error);
  if (d.ofPixels > 0.01)
    text += fmt::format("; pixels differ by {} of the mean (rms, noise taken off)", percentOf(d.ofPixels));
  return text;
}

std::string describeCost(double cost) {
  if (cost > 0.97 && cost < 1.03) return "takes as long";
  return fmt::format("takes {:.0f} % {} time", 100 * std::fabs(cost - 1), cost < 1 ? "less" : "more");
}

class Plan {
 public:
  Plan(const PlanArguments& arguments, const Console& console)
      : arguments_(arguments), console_(console), session_(arguments.render, console) {}

  ExitCode run() {
    if (!load(session_)) return ExitCode::badInput;
    pilot_ = renderPilot(session_, pilotSeconds);
    effects_ = listEffects(session_.description(), session_.scene());
    measureOutputs();
    console_.print(table());
    console_.print(sampling());
    if (!arguments_.render.without.empty() && !tellWhatIsForcedOff()) return ExitCode::badInput;
    console_.print(rest());
    return ExitCode::success;
  }

 private:
  bool load(SceneSession& session) const {
    if (!session.load()) return false;
    shrinkFilm(session.description().film, arguments_.size);
    return session.prepare();
  }

  /// The same pilot of the scene with other effects forced off; nothing when it cannot be prepared.
  std::optional<PilotReport> renderWithout(const std::vector<std::string>& effects) const {
    RenderArguments arguments = arguments_.render;
    arguments.without = effects;
    SceneSession session(arguments, silent_.get());
    if (!load(session)) return {};
    return renderPilot(session, pilotSeconds * 1e6, pilot_.samples);
  }

  /// What is gathered beside the picture has no phase of its own: it is what the render takes longer for it.
  void measureOutputs() {
    for (const Effect& effect : effects_) {
      if (!effect.isOn || (effect.name != "layers" && effect.name != "deep-output")) continue;
      std::vector<std::string> without = arguments_.render.without;
      without.push_back(effect.name);
      const auto other = renderWithout(without);
      if (other) measured_[effect.name] = std::max(0.0, 1 - other->processorSeconds / pilot_.processorSeconds);
    }
  }

  std::string table() const {
    std::size_t width = 6, rows = 4;
    for (const Effect& effect : effects_) {
      width = std::max(width, effect.name.size());
      rows = std::max(rows, rowsOfEffect(effect.name).size());
    }
    std::string text =
        fmt::format("Effects of {}\n  {:<{}}  {:<{}}  {:<3}  {:>7}  why\n", arguments_.render.scene.filename().string(),
                    "effect", width, "rows", rows, "", "share");
    for (const bool isOn : {true, false}) {
      for (const Effect& effect : effects_) {
        if (effect.isOn != isOn) continue;
        text += fmt::format("  {:<{}}  {:<{}}  {:<3}  {:>7}  {}\n", effect.name, width, rowsOfEffect(effect.name), rows,
                            effect.isOn ? "on" : "off", shareOf(effect), effect.reason);
      }
    }
    return text;
  }

  std::string shareOf(const Effect& effect) const {
    if (!effect.isOn) return {};
    if (const auto known = measured_.find(effect.name); known != measured_.end())
      return formatPercent(known->second, 1);
    const render::WorkerStatistics& statistics = pilot_.report.statistics;
    if (effect.share) return formatPercent(effect.share(statistics), 1);
    const auto nanoseconds = nanosecondsOfEvent(effect.name);
    if (!nanoseconds) return {};
    const double spent = *nanoseconds * static_cast<double>(effect.work(statistics));
    return "~" + formatPercent(std::min(1.0, 1e-9 * spent / std::max(pilot_.processorSeconds, 1e-9)), 1);
  }

  bool tellWhatIsForcedOff() const {
    std::string text = "Forced off\n";
    std::size_t width = 6;
    for (const std::string& name : arguments_.render.without) width = std::max(width, name.size());
    for (const RemovableEffect& effect : removableEffects()) {
      const auto& names = arguments_.render.without;
      if (std::find(names.begin(), names.end(), effect.name) == names.end()) continue;
      text += fmt::format("  {:<{}}  {}\n", effect.name, width, effect.consequence);
    }
    const auto before = renderWithout({});
    if (!before) return false;
    const Difference difference = compare(*before, pilot_);
    text += fmt::format("  measured: the pilot is {}; it {}\n", describe(difference), describeCost(difference.cost));
    console_.print(text);
    return true;
  }

  /// What no effect claims, and of what all shares are.
  std::string sampling() const {
    std::string text;
    for (const std::string& line : samplingOfMedia(session_.scene())) text += fmt::format("  {}\n", line);
    return text.empty() ? text : "Media are sampled by\n" + text;
  }

  std::string rest() const {
    std::string parts;
    for (const PhaseCost& cost : phaseCosts(pilot_.report.statistics)) {
      const bool isPathWork = cost.name == "paths" || cost.name == "gathering" || cost.name == "film";
      if (isPathWork)
        parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", formatPercent(cost.share, 1), cost.name);
    }
    return fmt::format(
        "Shares are of a pilot of {} at {} x {} pixels. The paths' own work is no effect's alone: {} (see aerosol "
        "render --explain-cost).\n~ by how often it was done, times what that takes about. Rows: aerosol help "
        "effects\n",
        formatCount(pilot_.samples, "sample"), pilot_.film->area().width(), pilot_.film->area().height(),
        parts.empty() ? "the pilot was too short to see" : parts);
  }

  const PlanArguments& arguments_;
  const Console& console_;
  SilentConsole silent_;
  SceneSession session_;
  PilotReport pilot_;
  std::vector<Effect> effects_;
  std::map<std::string, double> measured_;  ///< Shares.
};

}  // namespace

ExitCode planCommand(const PlanArguments& arguments, const Console& console) { return Plan(arguments, console).run(); }

}  // namespace aerosol::app

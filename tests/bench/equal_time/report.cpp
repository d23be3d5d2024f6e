#include "tests/bench/equal_time/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include "core/app/json.h"

namespace aerosol::bench {

namespace {

std::string text(const Spread& s) { return fmt::format("{:8.3g} [{:.3g}, {:.3g}]", s.median, s.low, s.high); }

double median(std::vector<double> values) { return Spread::of(std::move(values)).median; }

}  // namespace

std::string describe(const SceneResult& scene) {
  std::string out = fmt::format(
      "\n{}: reference of {} samples a pixel or more, error {:.2f} %; its halves' means differ by {:+.2f} % ± {:.2f}\n",
      scene.name, scene.referenceSamples, 100 * scene.referenceError, 100 * scene.halvesDiffer,
      100 * scene.halvesError);
  out += fmt::format("  {:<44}{:>8}{:>10}{:>11}{:>28}{:>18}\n", "", "samples", "seconds", "error", "error² × seconds",
                     "mean off by");
  for (const MethodResult& m : scene.methods) {
    out += fmt::format("  {:<44}{:>8}{:>10.3f}{:>9.2f} %{:>28}{:>+9.2f} % ± {:.2f}\n", m.name, m.samples,
                       median(m.seconds), 100 * std::sqrt(median(m.error)), text(Spread::of(m.cost)),
                       100 * m.meanDifference, 100 * m.meanDifferenceError);
  }
  if (const MethodResult* automatic = scene.find(automaticName)) {
    out += fmt::format("  automatic: {}\n", automatic->choices.substr(0, 400));
  }
  return out;
}

std::string summarise(const std::vector<SceneResult>& scenes) {
  std::string out = fmt::format("\n{:<26}{:>30}{:>30}{:>30}  {}\n", "ratios of error² × seconds",
                                "simplest / automatic", "pixel by pixel", "automatic / best forced", "best forced");
  std::vector<double> losses;
  for (const SceneResult& scene : scenes) {
    const MethodResult *automatic = scene.find(automaticName), *simplest = scene.find(simplestName);
    const MethodResult* best = scene.best();
    if (!automatic || !simplest || !best) continue;
    const Spread loss = ratio(automatic->cost, best->cost);
    losses.push_back(loss.median);
    out += fmt::format("{:<26}{:>30}{:>30}{:>30}  {}\n", scene.name, text(ratio(simplest->cost, automatic->cost)),
                       text(ratio(simplest->pixelCost, automatic->pixelCost)), text(loss), best->name);
  }
  if (losses.empty()) return out;
  out += fmt::format("automatic against the best forced choice: {:.2f} in the median, {:.2f} at worst\n",
                     median(losses), *std::ranges::max_element(losses));
  return out;
}

std::string toJson(const std::vector<SceneResult>& scenes, const Effort& effort) {
  app::JsonWriter json;
  const auto spread = [&](const char* name, const Spread& s) {
    json.key(name).beginObject().number("median", s.median).number("low", s.low).number("high", s.high).endObject();
  };
  json.beginObject().text("effort", effort.name).count("seeds", static_cast<std::uint64_t>(effort.seeds));
  json.key("scenes").beginArray();
  for (const SceneResult& scene : scenes) {
    json.beginObject().text("scene", scene.name);
    json.key("reference").beginObject().count("samples", scene.referenceSamples).number("error", scene.referenceError);
    json.number("halves_differ", scene.halvesDiffer).number("halves_error", scene.halvesError).endObject();
    json.key("methods").beginArray();
    for (const MethodResult& m : scene.methods) {
      json.beginObject().text("method", m.name).text("choices", m.choices).count("samples", m.samples);
      spread("error_squared_seconds", Spread::of(m.cost));
      spread("pixel_error_squared_seconds", Spread::of(m.pixelCost));
      spread("relative_mean_squared_error", Spread::of(m.error));
      spread("seconds", Spread::of(m.seconds));
      json.number("mean_difference", m.meanDifference).number("mean_difference_error", m.meanDifferenceError);
      json.endObject();
    }
    json.endArray().endObject();
  }
  json.endArray().endObject();
  return json.finish();
}

Result<Earlier> readJson(const std::string& file) {
  std::ifstream stream(file);
  const auto refuse = [&](const std::string& why) { return Diagnostic{.location = {file, 0, 0}, .message = why}; };
  if (!stream) return refuse("cannot be read");
  std::stringstream all;
  all << stream.rdbuf();
  const std::string content = all.str();
  // Only what is compared, in the order in which it was written.
  const std::regex entry(
      R"re("(effort|scene|method)": "([^"]*)"|"error_squared_seconds": \{\s*"median": ([-+.0-9eE]+))re");
  Earlier earlier;
  EarlierCost cost;
  for (auto i = std::sregex_iterator(content.begin(), content.end(), entry); i != std::sregex_iterator(); ++i) {
    const std::string key = (*i)[1].str(), value = (*i)[2].str();
    if (key == "effort") earlier.effort = value;
    if (key == "scene") cost.scene = value;
    if (key == "method") cost.method = value;
    if (!key.empty()) continue;
    cost.cost = std::strtod((*i)[3].str().c_str(), nullptr);
    earlier.costs.push_back(cost);
  }
  if (earlier.costs.empty()) return refuse("holds no measurements");
  return earlier;
}

std::string compare(const std::vector<SceneResult>& now, const Effort& effort, const Earlier& earlier) {
  std::string out = "\nerror² × seconds, over that of the earlier run\n";
  if (earlier.effort != effort.name) {
    out += fmt::format("  (the earlier run was a {} one: images of another size)\n", earlier.effort);
  }
  for (const SceneResult& scene : now) {
    for (const MethodResult& m : scene.methods) {
      const auto isSame = [&](const EarlierCost& c) { return c.scene == scene.name && c.method == m.name; };
      const auto before = std::ranges::find_if(earlier.costs, isSame);
      const std::string what = scene.name + ", " + m.name;
      if (before == earlier.costs.end() || !(before->cost > 0)) {
        out += fmt::format("  {:<70}     new\n", what);
        continue;
      }
      const Spread s = Spread::of(m.cost);
      out += fmt::format("  {:<70}{}\n", what,
                         text({s.low / before->cost, s.median / before->cost, s.high / before->cost}));
    }
  }
  return out;
}

}  // namespace aerosol::bench

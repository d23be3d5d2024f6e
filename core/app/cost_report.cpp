#include "core/app/cost_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "core/app/json.h"
#include "core/app/quantity.h"
#include "core/render/film_error.h"

namespace aerosol::app {

namespace {

constexpr std::array<std::string_view, shading::variantCount> variantNames{
    "coefficients", "extinction", "surface", "outputs", "velocity", "displacement"};
constexpr std::array<std::string_view, phaseCount> phaseNames{"paths",     "shaders", "gathering", "tracing",
                                                              "intervals", "lights",  "film"};
constexpr std::array<std::string_view, phaseCount> phaseMeanings{"trackers, scattering, bookkeeping of paths",
                                                                 "compiled shaders",
                                                                 "questions into batches, answers back",
                                                                 "rays against surfaces and volume primitives",
                                                                 "spans of volumes to segments",
                                                                 "choosing and sampling lights",
                                                                 "sums of samples"};

double number(std::uint64_t count) { return static_cast<double>(count); }

const char* nameOf(volume::DistanceMethod method) {
  switch (method) {
    case volume::DistanceMethod::closedForm:
      return "closed form";
    case volume::DistanceMethod::analytic:
      return "closed form of voxels";
    case volume::DistanceMethod::marching:
      return "marching";
    case volume::DistanceMethod::nullScattering:
      return "null scattering";
  }
  return "";
}

/// Counters of a render as one list, for a row of JSON each.
struct Counter {
  const char* name;
  std::uint64_t value;
};

std::vector<Counter> countersOf(const render::WorkerStatistics& s, const render::Film& film) {
  return {{"samples", s.samples},
          {"pathVertices", s.pathVertices},
          {"closestHitQueries", s.accel.closestHitQueries},
          {"occlusionQueries", s.accel.occlusionQueries},
          {"volumeTests", s.accel.volumeTests},
          {"volumeSpans", s.accel.spans},
          {"openVolumes", s.accel.openVolumes},
          {"invalidRays", s.accel.invalidRays},
          {"kernelCalls", s.kernelCalls},
          {"kernelPoints", s.kernelPoints},
          {"kernelLanes", s.kernelLanes},
          {"trackerPoints", s.trackers.points},
          {"boundViolations", s.trackers.boundViolations},
          {"stepLimits", s.trackers.stepLimits},
          {"hiddenHits", s.media.rejectedHits},
          {"exitsWithoutEntry", s.media.exitsWithoutEntry},
          {"repeatedEntries", s.media.repeatedEntries},
          {"invalidCoefficients", s.invalidCoefficients},
          {"amplifyingCoefficients", s.amplifyingCoefficients},
          {"invalidClosures", s.invalidClosures},
          {"droppedSamples", film.droppedCount()},
          {"frameHeapBlocks", s.frameHeapBlocks}};
}

void writeShaders(JsonWriter& json, const std::vector<ShaderCost>& costs) {
  json.key("shaders").beginArray();
  for (const ShaderCost& cost : costs) {
    const render::KernelStatistics& k = cost.work;
    json.beginObject()
        .text("shader", cost.shader)
        .text("variant", cost.variant)
        .count("instances", cost.instances)
        .count("calls", k.calls)
        .count("points", k.points)
        .number("nanosecondsAPoint", number(k.nanoseconds) / number(k.points))
        .number("lanesFilled", number(k.points) / number(k.lanes))
        .number("share", cost.share);
    if (k.countedLanesRun > 0) json.number("lanesUsed", number(k.countedLanesUsed) / number(k.countedLanesRun));
    json.endObject();
  }
  json.endArray();
}

}  // namespace

std::vector<ShaderCost> shaderCosts(const render::PreparedScene& scene, const render::WorkerStatistics& statistics,
                                    double threadSeconds) {
  std::vector<ShaderCost> costs;
  const auto& families = scene.shading.families();
  for (std::size_t i = 0; i < statistics.kernels.size(); ++i) {
    const render::KernelStatistics& work = statistics.kernels[i];
    if (work.calls == 0) continue;
    const shading::Family& family = families[i / shading::variantCount];
    costs.push_back({family.program->name, std::string(variantNames[i % shading::variantCount]),
                     family.instances.size(), work, number(work.nanoseconds) * 1e-9 / threadSeconds});
  }
  std::sort(costs.begin(), costs.end(), [](const ShaderCost& a, const ShaderCost& b) { return a.share > b.share; });
  return costs;
}

std::vector<PhaseCost> phaseCosts(const render::WorkerStatistics& statistics) {
  std::uint64_t seen = 0;
  for (const std::uint64_t count : statistics.phases) seen += count;
  std::vector<PhaseCost> costs;
  for (std::size_t i = 0; i < phaseCount && seen > 0; ++i) {
    costs.push_back({std::string(phaseNames[i]), number(statistics.phases[i]) / number(seen)});
  }
  return costs;
}

std::string explainCost(const render::PreparedScene& scene, const render::RenderReport& report, int threads) {
  const double threadSeconds = report.seconds * threads;
  std::string text = fmt::format("Cost: {} of {}\n", formatDuration(threadSeconds),
                                 formatCount(static_cast<std::uint64_t>(threads), "thread"));
  const auto costs = shaderCosts(scene, report.statistics, threadSeconds);
  std::size_t width = 6;
  for (const ShaderCost& cost : costs) width = std::max(width, cost.shader.size() + cost.variant.size() + 1);
  text += fmt::format("  {:<{}}  {:>7}  {:>8}  {:>8}  {:>8}  {:>6}\n", "shader", width, "share", "calls", "points",
                      "ns/point", "lanes");
  for (const ShaderCost& cost : costs) {
    const render::KernelStatistics& k = cost.work;
    const std::uint64_t run = k.countedLanesRun > 0 ? k.countedLanesRun : k.lanes;
    const std::uint64_t used = k.countedLanesRun > 0 ? k.countedLanesUsed : k.points;
    text += fmt::format("  {:<{}}  {:>7}  {:>8}  {:>8}  {:>8.1f}  {:>5.0f}%\n", cost.shader + " " + cost.variant, width,
                        formatPercent(cost.share, 1), formatShort(number(k.calls)), formatShort(number(k.points)),
                        number(k.nanoseconds) / number(k.points), 100 * number(used) / number(run));
  }
  const auto phases = phaseCosts(report.statistics);
  if (phases.empty()) return text + "  the render was too short to see where the rest went\n";
  text += "  all work\n";
  for (std::size_t i = 0; i < phases.size(); ++i) {
    text += fmt::format("    {:<10} {:>7}  {}\n", phases[i].name, formatPercent(phases[i].share, 1), phaseMeanings[i]);
  }
  return text;
}

std::string statisticsJson(const StatisticsRecord& record) {
  const render::WorkerStatistics& s = record.report.statistics;
  const double threadSeconds = record.report.seconds * record.threads;
  JsonWriter json;
  json.beginObject().text("scene", record.sceneFile);
  json.number("loadSeconds", record.times.load)
      .number("prepareSeconds", record.times.prepare)
      .number("renderSeconds", record.report.seconds)
      .count("threads", static_cast<std::uint64_t>(record.threads))
      .boolean("interrupted", record.report.interrupted)
      .number("relativeError", render::relativeError(record.film))
      .count("filmBytes", record.film.bytes());
  json.key("counters").beginObject();
  for (const Counter& counter : countersOf(s, record.film)) json.count(counter.name, counter.value);
  json.endObject();
  writeShaders(json, shaderCosts(record.scene, s, threadSeconds));
  json.key("phases").beginObject();
  for (const PhaseCost& cost : phaseCosts(s)) json.number(cost.name, cost.share);
  json.endObject();
  json.key("media").beginArray();
  for (std::size_t i = 0; i < record.scene.media.size(); ++i) {
    const volume::Medium& medium = record.scene.media[i];
    json.beginObject()
        .text("shader", record.scene.mediumNames[i])
        .text("method", nameOf(medium.method))
        .number("stepSize", static_cast<double>(medium.stepSize))
        .number("bound", medium.bound ? static_cast<double>(medium.bound->value) : 0)
        .endObject();
  }
  json.endArray().endObject();
  return json.finish();
}

}  // namespace aerosol::app

#include "core/app/statistics_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/app/quantity.h"

namespace aerosol::app {

namespace {

double number(std::uint64_t count) { return static_cast<double>(count); }
double ratio(std::uint64_t a, std::uint64_t b) { return b > 0 ? number(a) / number(b) : 0; }

/// Rows of a name and a text.
class Table {
 public:
  void row(const char* name, const std::string& value) { text_ += fmt::format("  {:<16}{}\n", name, value); }
  std::string take() { return "Statistics\n" + text_; }

 private:
  std::string text_;
};

std::string describeKernels(const render::PreparedScene& scene) {
  int kernels = 0, cached = 0;
  double seconds = 0;
  for (const shading::Family& family : scene.shading.families()) {
    for (const auto& kernel : family.kernels) {
      if (!kernel) continue;
      const jit::CompileTimes& t = kernel->times();
      ++kernels;
      cached += t.fromCache;
      seconds += t.lowering + t.linkRuntime + t.optimisation + t.codeGeneration + t.loading;
    }
  }
  return fmt::format("{} for {}, {} from the cache, {} of one processor", kernels,
                     formatCount(scene.shading.families().size(), "shader"), cached, formatDuration(seconds));
}

void addKernelCalls(Table& table, const render::WorkerStatistics& s, double threadSeconds) {
  table.row("shader points", fmt::format("{}, {:.1f} a sample, {:.0f} ns of a thread's whole work each",
                                         formatCount(s.kernelPoints), ratio(s.kernelPoints, s.samples),
                                         s.kernelPoints > 0 ? threadSeconds * 1e9 / number(s.kernelPoints) : 0));
  table.row("kernel calls", fmt::format("{}, {:.0f} points each in the mean", formatCount(s.kernelCalls),
                                        ratio(s.kernelPoints, s.kernelCalls)));
  std::string lanes = formatPercent(number(s.kernelPoints), number(s.kernelLanes)) + " filled by batches";
  if (s.countedLanesRun > 0) {
    lanes += fmt::format("; {} at work inside shaders, weighted by cost",
                         formatPercent(number(s.countedLanesUsed), number(s.countedLanesRun)));
  }
  table.row("lanes used", lanes);
}

void addTrackers(Table& table, const render::WorkerStatistics& s) {
  table.row("tracker points", fmt::format("{}, {} above their bound", formatCount(s.trackers.points),
                                          formatCount(s.trackers.boundViolations)));
  if (s.trackers.boundViolations > 0) {
    table.row("worst excess", fmt::format("{:.4g} times the bound", s.trackers.worstViolation));
  }
  if (s.media.rejectedHits > 0) table.row("hidden surfaces", formatCount(s.media.rejectedHits, "hit"));
  if (s.media.coincidentFaces > 0) table.row("coincident faces", formatCount(s.media.coincidentFaces, "crossing"));
  if (s.media.exitsWithoutEntry + s.media.repeatedEntries > 0) {
    table.row("open surfaces",
              fmt::format("{} without entry, {} that enter twice", formatCount(s.media.exitsWithoutEntry, "exit"),
                          formatCount(s.media.repeatedEntries, "hit")));
  }
  if (s.invalidCoefficients > 0) table.row("invalid results", formatCount(s.invalidCoefficients));
  if (s.amplifyingCoefficients > 0) table.row("albedo above 1", formatCount(s.amplifyingCoefficients, "result"));
  if (s.invalidVelocities > 0) table.row("invalid velocities", formatCount(s.invalidVelocities));
}

/// How overlapping volume primitives are found, where that is not the simple way.
void addOverlap(Table& table, const render::PreparedScene& scene) {
  if (scene.geometry->overlapDesign() != accel::OverlapDesign::partition) return;
  const accel::PartitionStatistics& s = scene.geometry->partitionStatistics();
  table.row("partition",
            fmt::format("{} volumes in {}, {} entries, {} of them left out as empty, at most {} in one, {}B",
                        formatCount(scene.geometry->volumeCount()), formatCount(s.regions, "region"),
                        formatCount(s.references + s.emptied), formatCount(s.emptied), formatCount(s.largestRegion),
                        formatShort(number(s.bytes))));
}

void addSampling(Table& table, const render::PreparedScene& scene) {
  for (const std::string& line : samplingOfMedia(scene)) table.row("distances", line);
  if (!scene.lights.tree().isEmpty()) {
    table.row("lights", fmt::format("{} in a hierarchy of {}B", formatCount(scene.lights.size(), "light"),
                                    formatShort(number(scene.lights.tree().bytes()))));
  }
}

/// The trees of bounds of all media, added up; shares are means over the trees.
void addBounds(Table& table, const render::PreparedScene& scene) {
  volume::BoundStatistics sum;
  std::uint64_t trees = 0;
  for (const volume::BoundStatistics& s : scene.treeStatistics) {
    if (s.boxes == 0) continue;
    ++trees;
    sum.boxes += s.boxes;
    sum.points += s.points;
    sum.bytes += s.bytes;
    sum.empty += s.empty;
    sum.uniform += s.uniform;
    sum.proven += s.proven;
    sum.declared += s.declared;
    sum.estimated += s.estimated;
    sum.emptyVolume += s.emptyVolume;
    sum.uniformVolume += s.uniformVolume;
    sum.tightness += s.tightness;
    sum.workingShare += s.workingShare;
    sum.seconds += s.seconds;
  }
  if (trees == 0) return;
  const double mean = 1 / number(trees);
  table.row("bounds",
            fmt::format("{} in {}, {}B, from {} boxes and {} points in {}",
                        formatCount(sum.empty + sum.uniform + sum.proven + sum.declared + sum.estimated, "part"),
                        formatCount(trees, "tree"), formatShort(number(sum.bytes)), formatCount(sum.boxes),
                        formatCount(sum.points), formatDuration(sum.seconds)));
  table.row("known leaves", fmt::format("{} empty ({} of the space), {} uniform ({})", formatCount(sum.empty),
                                        formatPercent(sum.emptyVolume * mean, 1), formatCount(sum.uniform),
                                        formatPercent(sum.uniformVolume * mean, 1)));
  table.row("bounded leaves", fmt::format("{} proven, {} declared, {} estimated", formatCount(sum.proven),
                                          formatCount(sum.declared), formatCount(sum.estimated)));
  table.row("tightness",
            fmt::format("the working bound is {:.2f} of the known one, and {:.2f} times the mean extinction",
                        sum.workingShare * mean, sum.tightness * mean));
}

}  // namespace

namespace {

/// Media that are sampled alike, but for the number of their bound.
struct SampledAlike {
  std::string before, after;  ///< Around the number.
  int count = 0;
  std::string least, most;  ///< Numbers; empty where there is none.
};

void addMedium(std::vector<SampledAlike>& rows, const std::string& text) {
  static constexpr std::string_view bound = "extinction is at most ";
  SampledAlike row{text, "", 0, "", ""};
  if (const std::size_t at = text.find(bound); at != std::string::npos) {
    const std::size_t begin = at + bound.size(), end = std::min(text.find_first_of(",; ", begin), text.size());
    row = {text.substr(0, begin), text.substr(end), 0, text.substr(begin, end - begin),
           text.substr(begin, end - begin)};
  }
  const auto known = std::ranges::find_if(
      rows, [&](const auto& each) { return each.before == row.before && each.after == row.after; });
  SampledAlike& group = known != rows.end() ? *known : rows.emplace_back(row);
  ++group.count;
  const auto isLess = [](const std::string& a, const std::string& b) {
    return std::atof(a.c_str()) < std::atof(b.c_str());
  };
  if (isLess(row.least, group.least)) group.least = row.least;
  if (isLess(group.most, row.most)) group.most = row.most;
}

}  // namespace

std::vector<std::string> samplingOfMedia(const render::PreparedScene& scene) {
  std::vector<SampledAlike> rows;
  for (std::size_t i = 0; i < scene.samplingReasons.size(); ++i)
    addMedium(rows, fmt::format("'{}': {}", scene.mediumNames[i], scene.samplingReasons[i]));
  std::vector<std::string> lines;
  for (const SampledAlike& row : rows) {
    const std::string bound = row.least == row.most ? row.most : fmt::format("{} to {}", row.least, row.most);
    lines.push_back(row.before + bound + row.after + (row.count == 1 ? "" : fmt::format(" ({} media)", row.count)));
  }
  return lines;
}

std::string formatStatistics(const render::PreparedScene& scene, const render::RenderReport& report,
                             const render::Film& film, const PreparationTimes& times, int threads,
                             const jit::ObjectCache* cache) {
  const render::WorkerStatistics& s = report.statistics;
  const double rate = report.seconds > 0 ? number(s.samples) / report.seconds : 0;
  Table table;
  table.row("time",
            fmt::format("{} to render on {}, {} to prepare, {} to read the scene", formatDuration(report.seconds),
                        formatCount(static_cast<std::uint64_t>(threads), "thread"), formatDuration(times.prepare),
                        formatDuration(times.load)));
  table.row("kernels", describeKernels(scene));
  if (cache) {
    const jit::CacheStatistics c = cache->statistics();
    table.row("cache",
              fmt::format("{} found, {} missed, {} damaged, {} written", c.hits, c.misses, c.damaged, c.written));
  }
  table.row("samples", fmt::format("{}, {} a second", formatCount(s.samples), formatShort(rate)));
  table.row("path vertices",
            fmt::format("{}, {:.2f} a sample", formatCount(s.pathVertices), ratio(s.pathVertices, s.samples)));
  table.row("rays", fmt::format("{} for hits, {} for shadows", formatCount(s.accel.closestHitQueries),
                                formatCount(s.accel.occlusionQueries)));
  if (s.accel.invalidRays > 0) table.row("invalid rays", formatCount(s.accel.invalidRays));
  if (s.accel.openVolumes > 0) table.row("rays through open volume meshes", formatCount(s.accel.openVolumes));
  addOverlap(table, scene);
  addSampling(table, scene);
  addBounds(table, scene);
  addKernelCalls(table, s, report.seconds * threads);
  addTrackers(table, s);
  if (film.droppedCount() > 0) table.row("dropped samples", formatCount(film.droppedCount()));
  table.row("film", fmt::format("{}B", formatShort(number(film.bytes()))));
  if (s.frameHeapBlocks > 0) {
    table.row("path frames", fmt::format("{} did not fit their slot", formatCount(s.frameHeapBlocks)));
  }
  return table.take();
}

}  // namespace aerosol::app

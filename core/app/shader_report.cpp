#include "core/app/shader_report.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>
#include <tuple>

#include "core/app/quantity.h"
#include "core/volume/trackers/null_scattering.h"

namespace aerosol::app {

namespace {

Severity severityOf(std::uint32_t kind) { return kind == AEROSOL_MESSAGE_ERROR ? Severity::error : Severity::warning; }

std::string describe(const render::PathId& path) {
  if (path.x < 0) return "a vertex, before the render";
  return fmt::format("pixel ({}, {}), sample {}", path.x, path.y, path.sample);
}

std::string withoutLineEnd(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string describe(Color color) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", color.r, color.g, color.b); }

bool isSound(Color color) { return isFinite(color) && minimum(color) >= 0; }

/// Those of the coefficients that are wrong.
std::string describeUnsound(const volume::Coefficients& given) {
  std::string text;
  const auto add = [&](bool isSound, const char* what, Color value) {
    if (!isSound) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", what, describe(value));
  };
  add(isSound(given.sigmaT), "extinction", given.sigmaT);
  add(isSound(given.sigmaS), "scattering", given.sigmaS);
  add(isFinite(given.emission), "emission", given.emission);
  return text;
}

/// Up to three digits, never below `value`.
double roundUp(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
  return std::ceil(value / unit) * unit;
}

}  // namespace

Diagnostics appendToFiles(const std::map<std::string, std::string>& files) {
  Diagnostics errors;
  for (const auto& [name, text] : files) {
    std::ofstream file(name, std::ios::binary | std::ios::app);
    if (!(file << text).flush())
      errors.warning({}, fmt::format("what a shader printed to '{}' cannot be written", name));
  }
  return errors;
}

ShaderReport reportMessages(const std::vector<render::Message>& messages, std::uint64_t dropped) {
  ShaderReport report;
  using Key = std::tuple<std::uint32_t, std::string, int, int, std::string>;
  std::map<Key, std::size_t> places;  // In `report.messages`.
  std::vector<std::uint64_t> counts;
  for (const render::Message& message : messages) {
    if (message.kind == AEROSOL_MESSAGE_PRINT) {
      report.printed += message.text;
      continue;
    }
    if (message.kind == AEROSOL_MESSAGE_FILE) {
      report.files[message.file] += message.text;
      continue;
    }
    const SourceLocation& at = message.location;
    const auto [place, isNew] =
        places.emplace(Key(message.kind, at.file, at.line, at.column, message.text), counts.size());
    if (isNew) {
      counts.push_back(0);
      report.messages.add(
          {severityOf(message.kind), at, withoutLineEnd(message.text), {}, {"at " + describe(message.path)}});
    }
    ++counts[place->second];
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 1) continue;
    report.messages.entries()[i].notes[0] =
        fmt::format("said {}, first {}", formatCount(counts[i], "time"), report.messages.entries()[i].notes[0]);
  }
  if (dropped > 0) {
    report.messages.warning({}, formatCount(dropped, "further shader message") + " not kept",
                            {"a shader that speaks at every point says little: use `if` to choose points"});
  }
  return report;
}

Diagnostics reportInvalidCoefficients(const render::PreparedScene& scene) {
  Diagnostics warnings;
  for (const auto& [medium, invalid] : scene.messages->invalid()) {
    const Point<World> p = invalid.point;
    const std::string place = invalid.isEverywhere ? "everywhere"
                                                   : fmt::format("first at {}, world point ({:.6g}, {:.6g}, {:.6g})",
                                                                 describe(invalid.path), p.x, p.y, p.z);
    warnings.warning(scene.mediumLocations[medium],
                     fmt::format("volume shader '{}' gave {} that no medium can have, taken as 0",
                                 scene.mediumNames[medium], formatCount(invalid.count, "result")),
                     {fmt::format("{}: {}", place, describeUnsound(invalid.given))});
  }
  return warnings;
}

Diagnostics reportAmplifyingMedia(const render::PreparedScene& scene) {
  Diagnostics warnings;
  for (const auto& [medium, found] : scene.messages->amplifying()) {
    const volume::Coefficients& given = found.given;
    const Point<World> p = found.point;
    const std::string place = found.isEverywhere ? "everywhere"
                                                 : fmt::format("first at {}, world point ({:.6g}, {:.6g}, {:.6g})",
                                                               describe(found.path), p.x, p.y, p.z);
    warnings.warning(
        scene.mediumLocations[medium],
        fmt::format("volume shader '{}' scatters more light than it takes from rays, an albedo above 1: light grows "
                    "from bounce to bounce, and the image is noisy or never settles",
                    scene.mediumNames[medium]),
        {fmt::format("{}: scattering {}, extinction {}; {} in all", place, describe(given.sigmaS),
                     describe(given.sigmaT), formatCount(found.count, "result")),
         "keep every channel of the albedo at 1 or below; for more light raise the lights or add emission()"});
  }
  return warnings;
}

Diagnostics reportInvalidClosures(const render::PreparedScene& scene) {
  Diagnostics warnings;
  for (const auto& [object, invalid] : scene.messages->invalidSurfaces()) {
    const lang::Program& program = *scene.shading.family(scene.objects[object].material).program;
    const lang::ClosureSite& site = program.closureSites[invalid.site];
    const Point<World> p = invalid.point;
    warnings.warning(
        program.locations[site.location],
        fmt::format("closure '{}' of surface shader '{}' had a weight or parameter that is no finite "
                    "number at {}; it is left out there",
                    site.closure, program.name, formatCount(invalid.count, "point")),
        {fmt::format("first at {}, world point ({:.6g}, {:.6g}, {:.6g})", describe(invalid.path), p.x, p.y, p.z)});
  }
  return warnings;
}

Diagnostics reportTrackers(const render::PreparedScene& scene, const volume::TrackerStatistics& trackers) {
  Diagnostics warnings;
  if (trackers.boundViolations > 0) {
    const volume::Medium& medium = scene.media[trackers.worstMedium];
    const auto largest = static_cast<double>(trackers.worstExtinction);
    const auto excess = static_cast<double>(trackers.worstViolation);
    const double bound = largest / excess;
    warnings.warning(
        scene.mediumLocations[medium.index],
        fmt::format("the extinction of '{}' was above its bound of {:.6g} at {}; {}", scene.mediumNames[medium.index],
                    bound, formatCount(trackers.boundViolations, "point"),
                    excess > 2 ? "so far above that no usual number of samples comes near the right image"
                               : "the image is right but noisier"),
        {fmt::format(
            "the largest value met was {:.6g}; declare <float name=\"density_bound\" value=\"{:.6g}\"/>, or more",
            largest, roundUp(largest))});
    // The second moment of ratio tracking under a bound μ̄ is exp(μ̄ ((σ/μ̄ - 1)² - 1)) per unit of length.
    if (excess > 2) {
      const double deviation = std::exp(0.5 * 10 * (std::pow(excess - 1, 2) - 1) / excess);
      warnings.entries().back().notes.push_back(fmt::format(
          "an excess of {:.3g} makes single values large: up to {:.2g} is the standard deviation of transmittance "
          "across an optical depth of 10",
          excess, deviation));
    }
  }
  if (trackers.stepLimits > 0) {
    warnings.warning({},
                     fmt::format("{} given up after {} tentative collisions",
                                 formatCount(trackers.stepLimits, "ray segment"), formatCount(volume::maximumSteps)),
                     {scene.messages && !scene.messages->amplifying().empty()
                          ? "a medium scatters more than it takes from rays: its paths do not die out"
                          : "a density bound is far above what the shader gives"});
  }
  return warnings;
}

Diagnostics reportLights(const render::WorkerStatistics& statistics) {
  Diagnostics warnings;
  if (statistics.raysIntoLights == 0) return warnings;
  warnings.warning({},
                   fmt::format("{} a point light inside of a medium, where its radiance has no limit",
                               statistics.raysIntoLights == 1 ? std::string("1 ray meets")
                                                              : formatCount(statistics.raysIntoLights) + " rays meet"),
                   {"the light was kept off by 1e-4 of the ray's way through media; set its 'radius' (scene units)"});
  return warnings;
}

Diagnostics reportClamping(const render::PreparedScene& scene, const render::WorkerStatistics& statistics) {
  Diagnostics warnings;
  if (!scene.path.clampsIndirect.isCalledFor()) return warnings;
  const std::uint64_t count = statistics.work.of(render::Work::clamping);
  warnings.warning({},
                   count == 0 ? std::string("clamp_indirect is on, and dimmed nothing")
                              : fmt::format("clamp_indirect dimmed light of paths {}: the picture is too dark",
                                            count == 1 ? "once" : formatCount(count) + " times"),
                   {"without it, or with 0, the picture has the right brightness"});
  return warnings;
}

Diagnostics reportReplacedAovs(const render::Film& film) {
  Diagnostics warnings;
  if (film.replacedAovs() > 0) {
    warnings.warning(
        {}, fmt::format("{} of AOVs were NaN or infinite and count as 0", formatCount(film.replacedAovs(), "value")));
  }
  return warnings;
}

Diagnostics reportDroppedSamples(const render::Film& film) {
  Diagnostics warnings;
  if (film.droppedCount() == 0) return warnings;
  std::vector<std::string> notes;
  for (const render::DroppedSample& sample : film.firstDropped()) {
    notes.push_back(fmt::format("pixel ({}, {}), sample {}: {}", sample.x, sample.y, sample.sample,
                                describe(Color(sample.value.color))));
  }
  warnings.warning({}, formatCount(film.droppedCount(), "sample") + " not finite and dropped", std::move(notes));
  return warnings;
}

}  // namespace aerosol::app

// What shaders said and did wrong during a render.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/render/film.h"
#include "core/render/message_log.h"
#include "core/render/prepared_scene.h"
#include "core/render/statistics.h"

namespace aerosol::app {

/// All that is printed once the image is safe.
struct ShaderReport {
  std::string printed;                       ///< Of printf, in the order (pixel, sample, call).
  std::map<std::string, std::string> files;  ///< Of fprintf: what goes to the end of each file.
  Diagnostics messages;  ///< warning(), error() and reports; one said many times stands where it was first said.
};

/// Writes the texts at the ends of the files.
Diagnostics appendToFiles(const std::map<std::string, std::string>& files);

/// `dropped` messages were too many to be kept.
ShaderReport reportMessages(const std::vector<render::Message>& messages, std::uint64_t dropped);

/// Results of volume shaders that were NaN, infinite or negative, once a medium.
Diagnostics reportInvalidCoefficients(const render::PreparedScene& scene);

/// Volume shaders with an albedo above 1, once a medium.
Diagnostics reportAmplifyingMedia(const render::PreparedScene& scene);

/// Closures of surface shaders with weights or parameters that were NaN or infinite, once an object.
Diagnostics reportInvalidClosures(const render::PreparedScene& scene);

/// Extinction above the bound that null scattering relies on, with the bound to declare instead; segments given up.
Diagnostics reportTrackers(const render::PreparedScene& scene, const volume::TrackerStatistics& trackers);

/// Point lights that rays met.
Diagnostics reportLights(const render::WorkerStatistics& statistics);

/// Light that the scene's limit dimmed.
Diagnostics reportClamping(const render::PreparedScene& scene, const render::WorkerStatistics& statistics);

/// Samples that were not finite, which the film dropped.
Diagnostics reportDroppedSamples(const render::Film& film);
/// Values of AOVs that were no finite numbers.
Diagnostics reportReplacedAovs(const render::Film& film);

}  // namespace aerosol::app

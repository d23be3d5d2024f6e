// How the media of a scene are sampled, as lines that can be kept and read back: what was chosen once is done again,
// whatever a later program, or a change of the scene that does not touch its media, would choose.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/scene/description.h"
#include "core/volume/medium.h"

namespace aerosol::render {

/// One medium's methods. Nothing is left open but what is the same either way.
struct SamplingChoice {
  std::string medium;  ///< Its shader's name.
  scene::MediumSampling sampling;

  friend bool operator==(const SamplingChoice& a, const SamplingChoice& b) {
    return a.medium == b.medium && a.sampling.distance == b.sampling.distance &&
           a.sampling.transmittance == b.sampling.transmittance && a.sampling.stepSize == b.sampling.stepSize;
  }
};

/// By index of the medium, in the order of the scene.
using SamplingPlan = std::vector<SamplingChoice>;

/// The words for what was decided about a medium; `stepSize` before any factors.
SamplingChoice choiceOf(const std::string& name, const volume::Medium& medium, float stepSize);

/// A line a medium: `NAME: distance WORD, transmittance WORD, step NUMBER`.
std::string toText(const SamplingPlan& plan);
/// What toText wrote. `file` is named in errors.
Result<SamplingPlan> parseSamplingPlan(const std::string& text, const std::string& file);

/// Why a plan is not for these media; empty when it is.
std::string whyNotFor(const SamplingPlan& plan, const std::vector<std::string>& mediumNames);

}  // namespace aerosol::render

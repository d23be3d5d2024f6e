// Lights that light some volumes and not others.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/render/light_set.h"
#include "core/scene/description.h"
#include "core/volume/medium.h"

namespace aerosol::render {

/// The lights of volumes and shapes that name them. The choice among lights, its densities and what rays find by
/// themselves are all of the same set, so everything stays exact.
struct LinkedLights {
  LightSet lights;  ///< With the indices, and the parts, of all lights.
  /// By accel::VolumeId: the media of volumes for rays that left such a volume. What does not light it does not glow.
  std::vector<const volume::Medium*> volumes;
  std::vector<const volume::Medium*> media;  ///< By medium index: the same for surface-defined media.

  /// A medium for such rays; null for null.
  const volume::Medium* seen(const volume::Medium* medium) const {
    const bool isKnown = medium && medium->index < media.size() && original(medium->index) == medium;
    return isKnown ? media[medium->index] : medium;
  }

  const volume::Medium* firstMedium = nullptr;  ///< The scene's media, one behind the other.

 private:
  const volume::Medium* original(std::uint32_t index) const { return firstMedium + index; }
};

/// By candidate, whether the `lights` of a volume or shape name it. Candidates without an id have an empty one. An
/// error at the parameter lists those ids that are `shining`.
Result<std::vector<bool>> namedLights(const std::string& list, const scene::Origin& origin,
                                      std::span<const std::string> ids, std::span<const std::string> shining);

}  // namespace aerosol::render

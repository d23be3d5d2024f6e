// What a surface shader said of a point: its closures with their weights, in the order of the call sites.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/color.h"
#include "core/base/small_array.h"

namespace aerosol::render {

/// Weights and parameters of a shader's closure sites, as the kernel delivered them.
struct SurfaceAnswer {
  static constexpr std::size_t maximumParameters = 32;
  /// Of ordinary materials; those that have more take longer.
  static constexpr std::size_t usualSites = 16;

  struct Site {
    Color weight;
    std::array<float, maximumParameters> parameters{};  ///< Components, one after the other.
  };
  SmallArray<Site, usualSites> sites;

  std::uint32_t siteCount() const { return static_cast<std::uint32_t>(sites.size()); }
};

/// What the texture of a light says: the weights of its closures.
inline Color lightTextureOf(const SurfaceAnswer& answer) {
  Color sum;
  for (std::uint32_t i = 0; i < answer.siteCount(); ++i) sum += answer.sites[i].weight;
  return isFinite(sum) ? sum : Color();
}

}  // namespace aerosol::render

// What a surface shader said of a point: its closures with their weights, in the order of the call sites.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/color.h"

namespace aerosol::render {

/// Weights and parameters of a shader's closure sites, as the kernel delivered them.
struct SurfaceAnswer {
  static constexpr std::size_t maximumSites = 16;
  static constexpr std::size_t maximumParameters = 32;

  struct Site {
    Color weight;
    std::array<float, maximumParameters> parameters{};  ///< Components, one after the other.
  };
  std::array<Site, maximumSites> sites;
  std::uint32_t siteCount = 0;
};

/// What the texture of a light says: the weights of its closures.
inline Color lightTextureOf(const SurfaceAnswer& answer) {
  Color sum;
  for (std::uint32_t i = 0; i < answer.siteCount; ++i) sum += answer.sites[i].weight;
  return isFinite(sum) ? sum : Color();
}

}  // namespace aerosol::render

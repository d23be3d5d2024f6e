// How lights are chosen together with places along rays.
#pragma once

#include <cstdint>

namespace aerosol::render {

enum class LightChoice : std::uint8_t {
  none,         ///< Not at all.
  equiangular,  ///< By a light's falloff along the ray, before the media on it are looked at.
  tabulated     ///< By falloff and media together, from the tables of marching.
};

}  // namespace aerosol::render

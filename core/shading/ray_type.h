// The kinds of rays that shaders can ask about.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace aerosol::shading {

/// Bits: a ray may be of several kinds.
namespace ray {
inline constexpr std::uint32_t camera = 1;
inline constexpr std::uint32_t shadow = 2;
inline constexpr std::uint32_t diffuse = 4;
inline constexpr std::uint32_t glossy = 8;
inline constexpr std::uint32_t reflection = 16;
inline constexpr std::uint32_t refraction = 32;
inline constexpr std::uint32_t subsurface = 64;
inline constexpr std::uint32_t displacement = 128;
}  // namespace ray

/// By bit number.
inline constexpr std::array<std::string_view, 8> rayTypeNames = {
    "camera", "shadow", "diffuse", "glossy", "reflection", "refraction", "subsurface", "displacement"};

}  // namespace aerosol::shading

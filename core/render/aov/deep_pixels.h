// The finished deep image of one pixel.
#pragma once

#include <span>
#include <vector>

#include "core/base/color.h"
#include "core/render/aov/deep_layout.h"

namespace aerosol::render {

/// A part of a pixel along depth, as deep images hold it: seen alone, in front of black.
struct DeepSample {
  float front = 0, back = 0;  ///< Depths; equal for a surface.
  Color opacity;              ///< 1 - T(back) / T(front), in [0, 1].
  Color light;                ///< What it adds to the picture over T(front).
};

/// What is behind everything stands here.
inline constexpr float deepBackground = 1e10f;

/// From the sums over `count` samples: what a pixel shows in depth order, with transmittance and light that both only
/// go one way and their whole as gathered. Neighbours are joined where both differ nowhere by more than `error` (light:
/// relative to all of it) from what was gathered.
std::vector<DeepSample> deepSamples(const AovDeep& deep, std::span<const double> sums, std::uint32_t count,
                                    double error);

/// The samples over each other, and how much of what is behind them they cover.
DeepSample flatten(std::span<const DeepSample> samples);

}  // namespace aerosol::render

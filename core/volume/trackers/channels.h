// Spectral multiple importance sampling over the three channels (Wilkie et al. 2014, "Hero wavelength spectral
// sampling"; Kutz et al. 2017, section 4): a distance is sampled for one channel and weighted by the mixture over all
// of them.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/color.h"
#include "core/volume/medium.h"

namespace aerosol::volume {

/// Probability of each channel, in proportion to the path's throughput; equal where it is black or not finite.
struct ChannelMixture {
  Color probability{1.0f / 3};

  explicit ChannelMixture(Color throughput) {
    const Color magnitude = abs(throughput);
    const float sum = magnitude.r + magnitude.g + magnitude.b;
    if (sum > 0 && std::isfinite(sum)) probability = magnitude / sum;
  }

  /// Channel for u in [0, 1); u becomes a fresh number in [0, 1).
  int choose(float& u) const {
    for (int c = 0; c < 2; ++c) {
      if (u < probability[c]) {
        u = std::min(u / probability[c], 0x1.fffffep-1f);
        return c;
      }
      u -= probability[c];
    }
    u = probability.b > 0 ? std::min(u / probability.b, 0x1.fffffep-1f) : 0.0f;
    return probability.b > 0 ? 2 : probability.g > 0 ? 1 : 0;
  }

  /// Mixture of the channels' values.
  float mix(Color c) const { return probability.r * c.r + probability.g * c.g + probability.b * c.b; }
};

inline Color withoutNegligible(Color sigma) {
  for (int c = 0; c < 3; ++c) sigma[c] = sigma[c] > negligibleExtinction ? sigma[c] : 0.0f;
  return sigma;
}

/// σ · length, where `length` may be infinite: 0 without extinction.
inline float opticalDepth(float sigma, float length) { return sigma > 0 ? sigma * length : 0.0f; }
inline Color opticalDepth(Color sigma, float length) {
  return {opticalDepth(sigma.r, length), opticalDepth(sigma.g, length), opticalDepth(sigma.b, length)};
}

/// ∫ exp(-σ s) ds over [0, length]: (1 - exp(-σ length)) / σ, exact to rounding as σ → 0. `length` may be infinite.
inline float transmittedLength(float sigma, float length) {
  const float depth = opticalDepth(sigma, length);
  return depth < 1e-8f ? length : -std::expm1(-depth) / sigma;
}
inline Color transmittedLength(Color sigma, float length) {
  return {transmittedLength(sigma.r, length), transmittedLength(sigma.g, length), transmittedLength(sigma.b, length)};
}

/// A weight below this share of the incoming throughput plays Russian roulette inside a tracker.
inline constexpr float trackerRouletteThreshold = 0.05f;

/// Russian roulette for a weight of which `size` is left. False where it ends; otherwise `weight` is raised to the
/// threshold.
template <UniformSource R>
bool survivesTrackerRoulette(Color& weight, float size, R& random) {
  if (size >= trackerRouletteThreshold) return true;
  if (!(random.next() * trackerRouletteThreshold < size)) return false;
  weight = weight * (trackerRouletteThreshold / size);
  return true;
}

}  // namespace aerosol::volume

// How far the mean of a pixel may be from the truth.
#pragma once

#include <array>
#include <cstdint>

#include "core/render/pixel_sum.h"

namespace aerosol::render {

/// Squared standard errors of the mean, by channel; 0 with fewer than two samples. `total` is the pixel's.
///
/// Independent samples: their scatter over n (n - 1). Where they are scrambled (scrambles.h) and at least
/// `leastScrambles` patterns have samples, the contrasts C_k = Σ s_kj S_j between the patterns' sums S_j of n_j
/// samples, N in all, s_kj = ±1 and H_k = Σ s_kj n_j:
///
///     Σ (C_k - H_k S/N)² / (N Σ (N - H_k²/N)),
///
/// which has the right mean whatever the variance of a pattern when all n_j are equal, and otherwise if it goes with
/// 1/n_j. With fewer patterns it is the former: stratified samples have a smaller error, this is a bound on it.
std::array<double, 3> squaredErrors(const PixelSum& pixel, const SampleSums& total, bool isScrambled,
                                    std::uint32_t leastScrambles);

}  // namespace aerosol::render

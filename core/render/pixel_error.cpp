#include "core/render/pixel_error.h"

#include <algorithm>
#include <cmath>

namespace aerosol::render {

namespace {

std::array<double, scrambleCount> countsOf(const PixelSum& pixel) {
  std::array<double, scrambleCount> counts{};
  for (const PixelSum::Range& range : pixel.ranges()) {
    for (std::uint32_t k = 0; k < scrambleCount; ++k) {
      counts[k] += static_cast<double>(countOfScramble(range.end, k) - countOfScramble(range.first, k));
    }
  }
  return counts;
}

}  // namespace

std::array<double, 3> squaredErrors(const PixelSum& pixel, const SampleSums& total, bool isScrambled,
                                    std::uint32_t leastScrambles) {
  std::array<double, 3> squares{};
  const double n = pixel.count();
  if (n < 2) return squares;
  std::array<double, scrambleCount> counts{};
  if (isScrambled) counts = countsOf(pixel);
  const auto used = static_cast<std::uint32_t>(std::ranges::count_if(counts, [](double count) { return count > 0; }));
  if (used < std::max(leastScrambles, 2u)) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double scatter = total.squares[c] - total.color[c] / n * total.color[c];
      squares[c] = std::max(0.0, scatter) / (n * (n - 1));
    }
    return squares;
  }
  double all = 0, weights = 0;
  for (const double count : counts) all += count;
  std::array<double, contrastCount> unevenness{};
  for (std::uint32_t k = 0; k < contrastCount; ++k) {
    for (std::uint32_t s = 0; s < scrambleCount; ++s) unevenness[k] += contrastSign(k, s) * counts[s];
    weights += all - unevenness[k] * unevenness[k] / all;
  }
  constexpr auto unit = static_cast<double>(SampleSums::contrastUnit);
  for (std::size_t c = 0; c < 3; ++c) {
    double scatter = 0;
    for (std::size_t k = 0; k < contrastCount; ++k) {
      const double off = unit * static_cast<double>(total.contrasts[k][c]) - unevenness[k] * total.color[c] / all;
      // Where all scrambles with samples count alike there is no contrast.
      if (all - std::fabs(unevenness[k]) > 0.5) scatter += off * off;
    }
    squares[c] = scatter / (weights * all);
  }
  return squares;
}

}  // namespace aerosol::render

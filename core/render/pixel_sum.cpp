#include "core/render/pixel_sum.h"

#include "core/render/sample_tree_impl.h"

namespace aerosol::render {

void SampleSums::add(const PixelSample& sample, std::uint32_t index) {
  const std::uint32_t scramble = scrambleOf(index);
  for (int c = 0; c < 3; ++c) {
    const double value = static_cast<double>(sample.color[c]);
    const auto i = static_cast<std::size_t>(c);
    color[i] += value;
    squares[i] += value * value;
    for (std::uint32_t k = 0; k < contrastCount; ++k) {
      contrasts[k][i] += static_cast<float>(contrastSign(k, scramble)) * (sample.color[c] / contrastUnit);
    }
  }
  alpha += static_cast<double>(sample.alpha);
}

SampleSums operator+(const SampleSums& a, const SampleSums& b) {
  SampleSums sum;
  for (std::size_t i = 0; i < 3; ++i) {
    sum.color[i] = a.color[i] + b.color[i];
    sum.squares[i] = a.squares[i] + b.squares[i];
  }
  sum.alpha = a.alpha + b.alpha;
  for (std::size_t k = 0; k < contrastCount; ++k) {
    for (std::size_t i = 0; i < 3; ++i) sum.contrasts[k][i] = a.contrasts[k][i] + b.contrasts[k][i];
  }
  return sum;
}

template class SampleTree<SampleSums, PixelSample>;

}  // namespace aerosol::render

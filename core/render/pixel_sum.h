// The sums of colour and coverage that a film keeps of each pixel.
#pragma once

#include <array>
#include <cmath>

#include "core/base/color.h"
#include "core/render/sample_tree.h"
#include "core/render/scrambles.h"

namespace aerosol::render {

/// What one sample of a pixel adds; signed. `alpha` is the coverage.
struct PixelSample {
  Color color;
  float alpha = 0;

  bool isFinite() const { return aerosol::isFinite(color) && std::isfinite(alpha); }
};

/// Sums over samples, in double.
struct SampleSums {
  std::array<double, 3> color{};
  double alpha = 0;
  std::array<double, 3> squares{};
  /// Contrasts between the scrambles, in units of `contrastUnit`: errors need no more digits, and no sum overflows.
  std::array<std::array<float, 3>, contrastCount> contrasts{};
  static constexpr float contrastUnit = 0x1p32f;

  void add(const PixelSample& sample, std::uint32_t index);
  friend SampleSums operator+(const SampleSums& a, const SampleSums& b);
  friend bool operator==(const SampleSums&, const SampleSums&) = default;
};

template <class A>
void describe(A& archive, SampleSums& sums) {
  for (double& value : sums.color) archive(value);
  archive(sums.alpha);
  for (double& value : sums.squares) archive(value);
  for (auto& contrast : sums.contrasts) {
    for (float& value : contrast) archive(value);
  }
}

template <class A>
void describe(A& archive, PixelSample& sample) {
  archive(sample.color.r, sample.color.g, sample.color.b, sample.alpha);
}

using PixelSum = SampleTree<SampleSums, PixelSample>;
extern template class SampleTree<SampleSums, PixelSample>;

}  // namespace aerosol::render

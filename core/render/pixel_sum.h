// The sums of colour and coverage that a film keeps of each pixel.
#pragma once

#include <array>
#include <cmath>

#include "core/base/color.h"
#include "core/render/sample_tree.h"

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

  void add(const PixelSample& sample);
  friend SampleSums operator+(const SampleSums& a, const SampleSums& b);
  friend bool operator==(const SampleSums&, const SampleSums&) = default;
};

template <class A>
void describe(A& archive, SampleSums& sums) {
  for (double& value : sums.color) archive(value);
  archive(sums.alpha);
  for (double& value : sums.squares) archive(value);
}

template <class A>
void describe(A& archive, PixelSample& sample) {
  archive(sample.color.r, sample.color.g, sample.color.b, sample.alpha);
}

using PixelSum = SampleTree<SampleSums, PixelSample>;
extern template class SampleTree<SampleSums, PixelSample>;

}  // namespace aerosol::render

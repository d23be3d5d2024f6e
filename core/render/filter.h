// Reconstruction filters by importance sampling: a sample belongs to one pixel and is drawn where the filter has
// weight.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/scene/description.h"

namespace aerosol::render {

/// Where on the film a sample of a pixel looks, relative to the pixel's centre, and the factor on its value: 1, or for
/// filters with negative lobes ±∫|f|/∫f.
struct FilterSample {
  float dx = 0, dy = 0;  ///< Pixels.
  float weight = 1;
};

/// A separable filter f(x) f(y). f is piecewise linear, which box and tent are anyway; others are approximated to
/// 2e-6 of their height.
class Filter {
 public:
  explicit Filter(const scene::ReconstructionFilter& filter);
  /// Any one-dimensional f on [-radius, radius] with a positive integral, through `cells` equal pieces.
  Filter(const std::function<double(double)>& f, double radius, int cells);

  /// `u` in [0, 1)².
  FilterSample sample(std::array<float, 2> u) const;
  /// f(x), scaled to the integral 1.
  double evaluate(double x) const;
  double radius() const { return knots_.back().x; }

 private:
  struct Knot {
    double x = 0;
    double f = 0;
    double cumulative = 0;  ///< ∫|f| up to x over ∫|f|.
  };
  struct Offset {
    double x = 0;
    bool negative = false;
  };

  void build(const std::vector<std::array<double, 2>>& points);
  Offset sampleAxis(double u) const;

  std::vector<Knot> knots_;
  std::vector<std::uint32_t> guide_;  ///< By equal shares of ∫|f|: the knot behind the beginning of the share.
  double integral_ = 1;               ///< ∫f.
  double weight_ = 1;                 ///< ∫|f| / ∫f.
};

}  // namespace aerosol::render

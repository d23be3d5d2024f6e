// A phase function from measured or computed values.
#pragma once

#include <vector>

#include "core/volume/phase.h"

namespace aerosol::volume {

/// Piecewise linear in the cosine of the deflection, from -1 (backwards) to 1 (straight on); has no parameters.
class TabulatedPhase final : public PhaseFunction {
 public:
  /// At least two values at equal distances, none negative, not all zero; they are scaled to the integral 1.
  explicit TabulatedPhase(std::vector<float> values);

  std::string_view name() const override { return "table"; }
  std::string_view doc() const override { return "Values over the cosine of the deflection"; }
  std::span<const DescribedField> fields() const override { return {}; }

  float evaluate(std::span<const float> parameters, const Deflection& deflection) const override;
  float pdf(std::span<const float> parameters, const Deflection& deflection) const override;
  PhaseSample sample(std::span<const float> parameters, Vector<World> before, std::array<float, 2> u) const override;
  float meanCosine(std::span<const float> parameters) const override;

 private:
  double step() const { return 2.0 / static_cast<double>(values_.size() - 1); }

  std::vector<double> values_;      ///< Per steradian.
  std::vector<double> cumulative_;  ///< Share of the light below each value's cosine.
};

}  // namespace aerosol::volume

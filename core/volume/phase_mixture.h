// Phase functions put together from others.
#pragma once

#include <memory>
#include <vector>

#include "core/volume/phase.h"

namespace aerosol::volume {

/// A weighted mean of phase functions with fixed parameters; has no parameters itself. Parts without spread (all light
/// in one direction) are chosen by their share and count as delta there.
class PhaseMixture final : public PhaseFunction {
 public:
  /// `share` > 0; `function` outlives the mixture.
  struct Part {
    float share = 1;
    std::shared_ptr<const PhaseFunction> function;
    std::vector<float> parameters;
  };

  /// The shares are divided by their sum. At least one part.
  explicit PhaseMixture(std::vector<Part> parts);

  std::string_view name() const override { return "mixture"; }
  std::string_view doc() const override { return "A weighted mean of other phase functions"; }
  std::span<const DescribedField> fields() const override { return {}; }

  float evaluate(std::span<const float> parameters, const Deflection& deflection) const override;
  float pdf(std::span<const float> parameters, const Deflection& deflection) const override;
  PhaseSample sample(std::span<const float> parameters, Vector<World> before, std::array<float, 2> u) const override;
  float meanCosine(std::span<const float> parameters) const override;

 private:
  std::vector<Part> parts_;
};

}  // namespace aerosol::volume
